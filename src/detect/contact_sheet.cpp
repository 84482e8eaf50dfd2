#include "detect/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace chromeball {
namespace {

constexpr int kCellWidth = 360, kCellHeight = 240, kCaption = 24, kGap = 8;

cv::Mat view_of(const Photo& picture) {
    // OpenCV has no const pictures; nothing is written to this one.
    auto* pixels = reinterpret_cast<unsigned char*>(const_cast<std::byte*>(picture.pixels.data()));
    return {picture.window.size.height, picture.window.size.width, CV_8UC3, pixels};
}

Photo rgb_photo(const cv::Mat& pixels) {
    Photo photo;
    photo.type = PixelType::u8;
    photo.channels = 3;
    photo.window = {0, 0, {pixels.cols, pixels.rows}};
    photo.display = photo.window.size;
    photo.color.space = "srgb_texture";
    const auto* bytes = reinterpret_cast<const std::byte*>(pixels.data);
    photo.pixels.assign(bytes, bytes + 3 * photo.window.size.pixels());
    return photo;
}

/// The caption as far as it fits; file names end with what tells them apart, so the start is cut.
std::string cut_to_fit(const std::string& caption) {
    constexpr std::size_t kFits = kCellWidth / 9;
    return caption.size() <= kFits ? caption : "..." + caption.substr(caption.size() - kFits + 3);
}

void draw_cell(cv::Mat& sheet, cv::Point corner, const SheetEntry& entry) {
    const Size size = entry.picture.window.size;
    if (!entry.picture.pixels.empty() && size.width <= kCellWidth && size.height <= kCellHeight) {
        const cv::Point middle =
            corner + cv::Point((kCellWidth - size.width) / 2, (kCellHeight - size.height) / 2);
        view_of(entry.picture).copyTo(sheet(cv::Rect(middle, cv::Size(size.width, size.height))));
    } else {
        cv::rectangle(sheet, cv::Rect(corner, cv::Size(kCellWidth, kCellHeight)), {60, 60, 60}, 1);
    }
    const cv::Scalar color = entry.good ? cv::Scalar(120, 230, 120) : cv::Scalar(255, 120, 100);
    cv::putText(sheet, cut_to_fit(entry.caption), corner + cv::Point(2, kCellHeight + kCaption - 8),
                cv::FONT_HERSHEY_SIMPLEX, 0.45, color, 1, cv::LINE_AA);
}

}  // namespace

Photo thumbnail(const Photo& picture) {
    const Size size = picture.window.size;
    if (size.pixels() == 0) return picture;
    const double scale = std::min({1.0, static_cast<double>(kCellWidth) / size.width,
                                   static_cast<double>(kCellHeight) / size.height});
    const auto scaled = [&](int length) {
        return std::max(1, static_cast<int>(std::floor(length * scale)));
    };
    cv::Mat small;
    cv::resize(view_of(picture), small, cv::Size(scaled(size.width), scaled(size.height)), 0, 0,
               cv::INTER_AREA);
    return rgb_photo(small);
}

Photo contact_sheet(const std::vector<SheetEntry>& entries) {
    const int count = std::max(1, static_cast<int>(entries.size()));
    // About as wide as high, which on a 3:2 cell is a row of the count's square root.
    const int columns = static_cast<int>(std::ceil(std::sqrt(count)));
    const int rows = (count + columns - 1) / columns;
    const int step_x = kCellWidth + kGap, step_y = kCellHeight + kCaption + kGap;
    cv::Mat sheet(rows * step_y + kGap, columns * step_x + kGap, CV_8UC3, cv::Scalar(24, 24, 24));
    for (int i = 0; i < static_cast<int>(entries.size()); ++i) {
        const cv::Point corner(kGap + i % columns * step_x, kGap + i / columns * step_y);
        draw_cell(sheet, corner, entries[static_cast<std::size_t>(i)]);
    }
    return rgb_photo(sheet);
}

}  // namespace chromeball
