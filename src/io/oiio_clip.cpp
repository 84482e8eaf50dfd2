#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <mutex>

#include "io/messages.h"
#include "io/oiio_doors.h"
#include "io/oiio_types.h"

namespace chromeball::io {
namespace {

using OIIO::ImageInput;
using OIIO::ImageSpec;

class OiioClip : public ClipReader {
public:
    explicit OiioClip(const std::string& path) : path_(path), input_(ImageInput::create("ffmpeg")) {
        if (!input_) {
            OIIO::geterror();  // clears it
            throw failure(path,
                          "this OpenImageIO reads no film clips; extract its frames as "
                          "pictures, with ffmpeg -i CLIP plate.%04d.png");
        }
        if (!input_->open(path, spec_))
            throw failure(path, fmt::format("cannot be read as a film clip: {}; copy or export it "
                                            "again",
                                            input_->geterror()));
        frames_ = spec_.get_int_attribute("oiio:subimages", 1);
    }

    int frames() const override { return frames_; }

    Photo read(int index, bool header_only) override {
        const std::lock_guard hold(lock_);
        if (index < 0 || index >= frames_)
            throw unreadable(index, fmt::format("it has {} frames", frames_));
        Photo photo;
        photo.name = fmt::format("{}[{}]", path_, index + 1);
        photo.type = spec_.format.size() > 1 ? PixelType::u16 : PixelType::u8;
        photo.channels = spec_.nchannels;
        photo.window = {0, 0, {spec_.width, spec_.height}};
        photo.display = photo.window.size;
        photo.associated_alpha = false;
        if (header_only) return photo;
        photo.pixels.resize(photo.window.size.pixels() * bytes_per_value(photo.type) *
                            static_cast<std::size_t>(photo.channels));
        const bool good = input_->seek_subimage(index, 0) &&
                          input_->read_image(index, 0, 0, photo.channels, type_desc_of(photo.type),
                                             photo.pixels.data());
        const std::string why = input_->geterror();
        if (!good || !why.empty()) throw unreadable(index, why);
        return photo;
    }

private:
    Error unreadable(int index, const std::string& why) const {
        return failure(path_, fmt::format("frame {} cannot be read: {}; copy or export the clip "
                                          "again",
                                          index + 1, why.empty() ? "damaged" : why));
    }

    std::string path_;
    std::unique_ptr<ImageInput> input_;
    ImageSpec spec_;
    int frames_ = 0;
    std::mutex lock_;
};

}  // namespace

std::unique_ptr<ClipReader> oiio::open_clip(const std::string& path) {
    return std::make_unique<OiioClip>(path);
}

}  // namespace chromeball::io
