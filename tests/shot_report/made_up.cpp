#include "shot_report/made_up.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "cli/program.h"
#include "cli/world.h"

namespace chromeball::test {

ShotReport made_up_shot(int frames) {
    ShotReport report;
    report.title = "plates/sh010.####.exr";
    report.settings_json =
        R"({"layout":"latlong","size":512,"camera":{"focal_px":2400.5,"principal":[960,540]},"lock":false})";
    report.wall_seconds = 0.05 * frames;
    report.jobs = 2;
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 0.06);
    for (int i = 0; i < frames; ++i) {
        FrameReport frame;
        frame.frame = 1001 + i;
        const double t = i / 40.0;
        const double r = 180 + 8 * std::sin(t / 2);
        frame.outline = Outline{900 + 120 * std::sin(t), 520 + 30 * std::cos(1.7 * t), r, r, 0};
        frame.tracked =
            Outline{frame.outline->cx + noise(random), frame.outline->cy + noise(random),
                    r + noise(random), r + noise(random) / 2, 12};
        frame.outcome = FrameOutcome::found;
        frame.confidence = 0.95 + 0.03 * std::sin(3 * t);
        frame.seconds = 0.08 + 0.02 * std::abs(noise(random));
        const int k = i % 100;
        if (k % 16 == 7) frame.seconds *= 2.5;
        if (k >= 40 && k < 48) {
            frame.outcome = FrameOutcome::filled;
            frame.flagged = k == 40;
            if (k == 44) frame.tracked->cx += 400;
            if (k != 44) frame.tracked.reset();
            frame.confidence = 0.2;
            frame.message = "hidden by <something> & overruled";
        } else if (k == 61 || k == 62) {
            frame.outcome = FrameOutcome::held;
            frame.tracked.reset();
            frame.flagged = true;
            frame.confidence = 0;
            frame.message = "no ball found; the outline of frame 1061 is held";
        } else if (k == 80) {
            frame.outcome = FrameOutcome::missing;
            frame.outline.reset();
            frame.tracked.reset();
            frame.flagged = true;
            frame.confidence = 0;
            frame.message = "there is no such file";
        } else if (k == 90) {
            frame.outcome = FrameOutcome::failed;
            frame.outline.reset();
            frame.tracked.reset();
            frame.flagged = true;
            frame.confidence = 0;
            frame.seconds = 0.01;
            frame.message = "plates/sh010.1091.exr: the file ends early (4 of 9 MB are there)";
        }
        report.frames.push_back(frame);
    }
    return report;
}

std::string made_up_png(int width, int height, int seed) {
    Image image({width, height}, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double dx = (x + 0.5) / width - 0.5 - 0.1 * std::sin(seed / 9.0);
            const double dy = ((y + 0.5) / height - 0.5) * height / width;
            const double distance = std::hypot(dx, dy) / 0.16;
            const bool ball = distance < 1;
            const double shade = ball ? 0.6 * std::sqrt(1 - distance * distance) : 0.1 + 0.2 * dy;
            float* pixel = image.pixel(x, y);
            pixel[0] = static_cast<float>(std::max(0.0, shade + 0.1 * dx));
            pixel[1] = static_cast<float>(std::max(0.0, shade + 0.05 * std::sin(seed * 0.2)));
            pixel[2] = static_cast<float>(std::max(0.0, shade - 0.1 * dx));
        }
    const TempFolder folder;
    write_picture(folder / "a.png", image);
    return read_bytes(folder / "a.png");
}

}  // namespace chromeball::test
