#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>

#include <random>

#include "io/files.h"
#include "io/write.h"

// EXR files are not written by OpenEXR: it must read them as if they were.

namespace chromeball {
namespace {

using test::TempFolder;

/// Smooth values, or noise that deflate cannot shrink; alpha and confidence from 0 to 1.
Image picture(Size size, int channels, bool noise) {
    Image image = test::pattern(size, channels);
    if (!noise) return image;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> logarithm(-10, 10), share(0, 1);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            for (int c = 0; c < channels; ++c)
                image.pixel(x, y)[c] = c < 3 ? std::exp2(logarithm(random)) : share(random);
    return image;
}

/// A channel as OpenEXR reads it.
std::vector<float> channel(Imf::InputFile& file, const char* name, Size size) {
    std::vector<float> values(size.pixels());
    Imf::FrameBuffer buffer;
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, values.data(), file.header().dataWindow()));
    file.setFrameBuffer(buffer);
    file.readPixels(0, size.height - 1);
    return values;
}

TEST(ExrZipWrite, TheLibraryReadsWhatWasWritten) {
    const TempFolder folder;
    const std::string file = folder / "x.exr";
    constexpr Size kSizes[] = {{37, 70}, {1, 17}, {1, 1}, {300, 1}, {8, 128}, {33, 200}};
    constexpr const char* kNames[] = {"R", "G", "B", "A", "confidence"};
    for (const Size size : kSizes)
        for (const int channels : {1, 3, 4, 5})
            for (const bool full_float : {false, true})
                for (const bool noise : {false, true}) {
                    const Image image = picture(size, channels, noise);
                    WriteOptions options;
                    options.full_float = full_float;
                    options.confidence = channels == 5;
                    write_image(file, image.view(), options);
                    Imf::InputFile in(file.c_str());
                    ASSERT_TRUE(in.isComplete());
                    for (int c = 0; c < channels; ++c) {
                        const auto values = channel(in, channels == 1 ? "Y" : kNames[c], size);
                        for (std::size_t i = 0; i < values.size(); ++i) {
                            const auto x = static_cast<int>(i) % size.width;
                            const auto y = static_cast<int>(i) / size.width;
                            const float value = image.pixel(x, y)[c];
                            ASSERT_EQ(values[i], full_float ? value : float(Imath::half(value)))
                                << x << ' ' << y << ' ' << c;
                        }
                    }
                }
}

TEST(ExrZipWrite, NoiseIsNotMadeLonger) {
    const TempFolder folder;
    const Size size{256, 64};
    Image image = picture(size, 3, true);
    // All bits of the values at random.
    std::mt19937 random(3);
    for (int y = 0; y < size.height; ++y)
        for (int i = 0; i < 3 * size.width; ++i) {
            const std::uint32_t bits = (static_cast<std::uint32_t>(random()) & 0x3fffffffu) | 1;
            std::memcpy(image.row(y) + i, &bits, 4);
        }
    WriteOptions options;
    options.full_float = true;
    write_image(folder / "x.exr", image.view(), options);
    const std::size_t pixels = size.pixels() * 12, chunks = 4;
    EXPECT_LT(test::read_bytes(folder / "x.exr").size(), pixels + chunks * 16 + 2048);
    Imf::InputFile in((folder / "x.exr").c_str());
    const auto green = channel(in, "G", size);
    for (std::size_t i = 0; i < green.size(); ++i) ASSERT_EQ(green[i], image.row(0)[3 * i + 1]);
}

TEST(ExrZipWrite, TheHeadIsTheLibrarysOwn) {
    const TempFolder folder;
    for (const std::size_t length : {8u, 31u, 32u, 200u}) {
        WriteOptions options;
        options.envmap = EnvmapKind::latlong;
        options.color.chromaticities = {0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767};
        options.metadata.set(std::string(length, 'n'), "some text");
        write_image(folder / "ours.exr", picture({20, 30}, 4, false).view(), options);
        const Imf::InputFile in((folder / "ours.exr").c_str());
        { const Imf::OutputFile out((folder / "theirs.exr").c_str(), in.header()); }
        const std::string ours = test::read_bytes(folder / "ours.exr");
        const std::string theirs = test::read_bytes(folder / "theirs.exr");
        // Of theirs only the table of contents follows: two chunks.
        ASSERT_GT(theirs.size(), std::size_t{316} + length);
        EXPECT_EQ(ours.substr(0, theirs.size() - 16), theirs.substr(0, theirs.size() - 16))
            << length;
    }
}

}  // namespace
}  // namespace chromeball
