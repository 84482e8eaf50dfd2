#include "resample/scalar.h"

#include "resample/pass.h"

namespace chromeball::scalar {

Image resample(const Source& source, const Layout& layout, int size, const ResampleOptions& options,
               const Watch& watch) {
    Image out(layout.picture(size), 4);
    scalar::resample(source, layout, out.view(), options, watch);
    return out;
}

void resample(const Source& source, const Layout& layout, ImageView<float> out,
              const ResampleOptions& options, const Watch& watch) {
    std::visit(
        [&]<class T, class P>(const T& target, const P&) {
            const Lookup<P> lookup(source);
            const Pass<T, P> pass(target, out.size, options.rotation.inverse(), lookup);
            if (options.filter == Filter::fast)
                for_each_pixel(out, watch, [&](int x, int y) { return pass.fast(x, y); });
            else
                for_each_pixel(out, watch, [&](int x, int y) { return pass.adaptive(x, y); });
        },
        layout.projection, source.projection);
}

}  // namespace chromeball::scalar
