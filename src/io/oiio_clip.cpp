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
    explicit OiioClip(const std::string& path) : path_(path), input_(opened()) {
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
        // The reader never drains the decoder: the last frames of codecs that reorder them cannot
        // be had, and where another was read before they would silently repeat that. A reader of
        // their own for those that may be concerned (decoders hold back 16 at most) has nothing to
        // repeat.
        constexpr int kHeldBack = 17;
        if (index >= frames_ - kHeldBack) input_ = opened();
        const bool good = input_->seek_subimage(index, 0) &&
                          input_->read_image(index, 0, 0, photo.channels, type_desc_of(photo.type),
                                             photo.pixels.data());
        const std::string why = input_->geterror();
        if ((!good || !why.empty()) && index >= frames_ - kHeldBack)
            throw unreadable(index,
                             "it is one of the last, which this reader cannot give where a codec "
                             "stores frames out of order (H.264 and H.265 with B-frames)");
        if (!good || !why.empty()) throw unreadable(index, why);
        return photo;
    }

private:
    std::unique_ptr<ImageInput> opened() {
        auto reader = ImageInput::create("ffmpeg");
        if (!reader) {
            OIIO::geterror();  // clears it
            throw failure(path_,
                          "this OpenImageIO reads no film clips; extract its frames as "
                          "pictures, with ffmpeg -i CLIP plate.%04d.png");
        }
        if (!reader->open(path_, spec_))
            throw failure(path_, fmt::format("cannot be read as a film clip: {}; copy or export "
                                             "it again",
                                             reader->geterror()));
        return reader;
    }

    Error unreadable(int index, const std::string& why) const {
        return failure(path_, fmt::format("frame {} cannot be read: {}; extract the frames as "
                                          "pictures, with ffmpeg -i CLIP plate.%04d.png",
                                          index + 1, why.empty() ? "damaged" : why));
    }

    std::string path_;
    ImageSpec spec_;
    std::unique_ptr<ImageInput> input_;
    int frames_ = 0;
    std::mutex lock_;
};

}  // namespace

std::unique_ptr<ClipReader> oiio::open_clip(const std::string& path) {
    return std::make_unique<OiioClip>(path);
}

}  // namespace chromeball::io
