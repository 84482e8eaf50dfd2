#pragma once

#include <Imath/half.h>
#include <stdlib.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "core/error.h"
#include "core/image.h"
#include "core/photo.h"

// What the tests of files share.

namespace chromeball::test {

/// A folder of its own that vanishes with the test.
class TempFolder {
public:
    TempFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "ioXXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
    }
    ~TempFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;
    std::string operator/(const std::string& name) const { return path_ + "/" + name; }
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

inline std::string read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::string& path, std::string_view bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), std::ssize(bytes));
}

/// The text of the Error that the job throws; "no error" when it throws none.
inline std::string message_of(const std::function<void()>& job) {
    try {
        job();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

/// A value of a photo by its place in the pixels that were read; integers as 0 to 1.
inline double value_at(const Photo& photo, int x, int y, int channel) {
    const std::size_t at =
        (Size{photo.window.size.width, y}.pixels() + static_cast<std::size_t>(x)) *
            static_cast<std::size_t>(photo.channels) +
        static_cast<std::size_t>(channel);
    const auto load = [&](auto example) {
        std::memcpy(&example, photo.pixels.data() + at * sizeof example, sizeof example);
        return example;
    };
    switch (photo.type) {
        case PixelType::u8:
            return load(std::uint8_t{}) / 255.0;
        case PixelType::u16:
            return load(std::uint16_t{}) / 65535.0;
        case PixelType::f16:
            return imath_half_to_float(load(std::uint16_t{}));
        case PixelType::f32:
            return static_cast<double>(load(float{}));
    }
    return 0;
}

/// A picture in which every pixel and channel differs from its neighbours, values in (0, 1); a
/// fourth channel is alpha, the colours below it (multiplied by it).
inline Image pattern(Size size, int channels) {
    Image image(size, channels);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            float* pixel = image.pixel(x, y);
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(size.width);
            const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height);
            const float values[] = {u, v, 0.5f * (1 - u) + 0.25f * v, 0.5f + 0.5f * u * v,
                                    0.5f * v};
            for (int c = 0; c < channels; ++c) pixel[c] = values[c];
            if (channels >= 4)
                for (int c = 0; c < 3; ++c) pixel[c] *= pixel[3];
        }
    return image;
}

}  // namespace chromeball::test
