// What somebody with the installed library writes first: a little of several layers.
#include <iostream>

#include "color/color.h"
#include "core/error.h"
#include "io/read.h"
#include "io/write.h"
#include "map/layouts.h"

int main() {
    const auto config = chromeball::ColorConfig::built_in();
    std::cout << config.space("scene_linear") << ' ' << chromeball::layout_names().front() << '\n';
    try {
        chromeball::read_photo("nowhere.jpg");
    } catch (const chromeball::Error& e) {
        std::cout << e.what() << '\n';
    }
    // A format whose library is loaded when it is needed.
    chromeball::Image image({3, 2}, 3);
    chromeball::WriteOptions options;
    options.format = chromeball::FileFormat::hdr;
    chromeball::write_image("consumer.hdr", image.view(), options);
    std::cout << chromeball::read_photo("consumer.hdr").display.width << '\n';
}
