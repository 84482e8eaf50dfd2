// The same mirror ball unwrapped by chromeball and by the usual tools: time per pixel and distance
// from a conversion with 256 samples a pixel; then whole processes in turn. Prints tables in
// Markdown. Tools that are not installed are left out.
#include <ImfRgbaFile.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/parallel.h"
#include "resample/resample.h"
#include "resample/tap.h"

namespace chromeball {
namespace {

namespace fs = std::filesystem;

constexpr int kDiameter = 2048;
constexpr double kRim = 150;  // degrees from the camera; beyond is told apart

/// Smooth colours, lines every 15 degrees, checks of 3: within 0.02 to 0.95.
V3d scene(V3d d) {
    const double degree = 180 / std::numbers::pi;
    const double lon = std::atan2(d.x, d.z) * degree;
    const double lat = std::asin(std::clamp(d.y, -1.0, 1.0)) * degree;
    const auto from_line = [](double a) { return std::abs(std::remainder(a, 15)); };
    if (std::min(from_line(lon) * std::cos(lat / degree), from_line(lat)) < 0.4)
        return {0.95, 0.95, 0.95};
    const auto cell = static_cast<int>(std::floor(lon / 3) + std::floor(lat / 3));
    const double check = cell % 2 == 0 ? 0 : 0.1;
    return d * 0.25 + V3d(0.4 + check, 0.4 + check, 0.4 + check);
}

MirrorBall distant_ball() {
    const double r = 0.5 * kDiameter;
    return MirrorBall(Outline{r, r, r, r, 0});
}

Image painted_ball() {
    Image photo({kDiameter, kDiameter}, 3);
    const MirrorBall ball = distant_ball();
    for_each_band(kDiameter, 16, [&](int first, int last) {
        for (int y = first; y < last; ++y)
            for (int x = 0; x < kDiameter; ++x) {
                V3d sum(0, 0, 0);
                for (int k = 0; k < 4; ++k) {
                    const V2d p(x + 0.25 + 0.5 * (k % 2), y + 0.25 + 0.5 * (k / 2));
                    if (const auto d = ball.to_direction(p)) sum += scene(*d);
                }
                for (int c = 0; c < 3; ++c) photo.pixel(x, y)[c] = static_cast<float>(sum[c] / 4);
            }
    });
    return photo;
}

// ---- time

double cpu_seconds(int who) {
    rusage usage{};
    getrusage(who, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

struct Cost {
    double cpu = 0, wall = 0;
};

/// A command's cost; the program ends if it fails.
Cost cost_of(const std::string& command) {
    const double before = cpu_seconds(RUSAGE_CHILDREN);
    const auto start = std::chrono::steady_clock::now();
    if (std::system((command + " >/dev/null 2>&1").c_str()) != 0) {
        fmt::print(stderr, "failed: {}\n", command);
        std::exit(1);
    }
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    return {cpu_seconds(RUSAGE_CHILDREN) - before, wall.count()};
}

bool installed(const std::string& tool) {
    return std::system(fmt::format("command -v {} >/dev/null 2>&1", tool).c_str()) == 0;
}

template <class Work>
double own_cpu_of(const Work& work) {
    const double before = cpu_seconds(RUSAGE_SELF);
    work();
    return cpu_seconds(RUSAGE_SELF) - before;
}

// ---- quality

/// Pixels that are compared: every kStep-th of each face, in both directions.
constexpr int kStep = 7;

struct Sample {
    int face, x, y;
    bool rim;  // beyond kRim degrees
    V3d expected;
};

/// 16 x 16 samples a pixel, each bilinear in the photo.
std::vector<Sample> reference(const Source& source, int size) {
    const Lookup<MirrorBall> lookup(source);
    const Cube cube;
    std::vector<Sample> samples;
    for (int face = 0; face < 6; ++face)
        for (int y = 3; y < size; y += kStep)
            for (int x = 3; x < size; x += kStep) {
                const V3d d =
                    cube.direction_on(face, 2 * (x + 0.5) / size - 1, 2 * (y + 0.5) / size - 1);
                samples.push_back({face, x, y, d.z < std::cos(kRim * std::numbers::pi / 180), {}});
            }
    for_each_band(static_cast<int>(samples.size()), 256, [&](int first, int last) {
        for (int i = first; i < last; ++i) {
            Sample& s = samples[static_cast<std::size_t>(i)];
            s.expected = V3d(0, 0, 0);
            for (int k = 0; k < 256; ++k) {
                const V3d d = cube.direction_on(s.face, 2 * (s.x + (k % 16 + 0.5) / 16) / size - 1,
                                                2 * (s.y + (k / 16 + 0.5) / 16) / size - 1);
                const auto at = lookup.locate(d);
                const auto tap = at ? lookup.tap(*at) : std::nullopt;
                if (tap) s.expected += V3d(tap->r, tap->g, tap->b) / 256;
            }
        }
    });
    return samples;
}

struct Quality {
    double front = 0, rim = 0;  ///< PSNR up to kRim degrees, and beyond
};

/// color(sample) -> what a tool has there.
template <class Color>
Quality quality_of(const std::vector<Sample>& samples, const Color& color) {
    double squares[2] = {0, 0}, count[2] = {1e-9, 1e-9};
    for (const Sample& s : samples) {
        squares[s.rim] += (color(s) - s.expected).length2() / 3;
        count[s.rim] += 1;
    }
    const auto psnr = [&](int part) { return -10 * std::log10(squares[part] / count[part]); };
    return {psnr(0), psnr(1)};
}

/// A picture of six faces side by side, 16 bits, as ffmpeg writes it.
struct Strip {
    int size = 0;
    std::vector<unsigned char> bytes;
    V3d at(int part, int x, int y) const {
        const std::size_t i =
            6 * (static_cast<std::size_t>(y) * 6 * static_cast<std::size_t>(size) +
                 static_cast<std::size_t>(part * size + x));
        const auto value = [&](std::size_t c) {
            return (bytes[i + 2 * c] * 256 + bytes[i + 2 * c + 1]) / 65535.0;
        };
        return {value(0), value(1), value(2)};
    }
};

/// Where a tool that turns, mirrors and orders faces in its own way puts a pixel of ours.
struct Placement {
    int part = 0, turn = 0;
    V2d moved(double x, double y, int size) const {
        if (turn & 4) x = size - 1 - x;
        for (int k = 0; k < (turn & 3); ++k) std::tie(x, y) = std::pair(size - 1 - y, x);
        return {x, y};
    }
};

Quality quality_of_strip(const std::vector<Sample>& samples, const Strip& strip) {
    std::array<Placement, 6> placements;
    const auto color = [&](const Sample& s, const Placement& p) {
        const V2d at = p.moved(s.x, s.y, strip.size);
        return strip.at(p.part, static_cast<int>(at.x), static_cast<int>(at.y));
    };
    for (int face = 0; face < 6; ++face) {
        double best = 1e30;
        for (int k = 0; k < 48; ++k) {
            const Placement tried{k / 8, k % 8};
            double squares = 0;
            for (const Sample& s : samples)
                if (s.face == face) squares += (color(s, tried) - s.expected).length2();
            if (squares >= best) continue;
            best = squares;
            placements[static_cast<std::size_t>(face)] = tried;
        }
    }
    return quality_of(samples, [&](const Sample& s) {
        return color(s, placements[static_cast<std::size_t>(s.face)]);
    });
}

// ---- files

void write_ppm(const Image& image, const fs::path& path) {
    std::ofstream out(path, std::ios::binary);
    out << fmt::format("P6\n{} {}\n65535\n", image.width(), image.height());
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            for (int c = 0; c < 3; ++c) {
                const auto v = static_cast<unsigned>(std::lround(image.pixel(x, y)[c] * 65535.0F));
                out.put(static_cast<char>(v >> 8)).put(static_cast<char>(v & 255));
            }
}

Strip read_ppm(const fs::path& path, int size) {
    std::ifstream in(path, std::ios::binary);
    std::string word;
    for (int k = 0; k < 4; ++k) in >> word;
    in.get();
    Strip strip{size, std::vector<unsigned char>(static_cast<std::size_t>(size) * size * 36)};
    in.read(reinterpret_cast<char*>(strip.bytes.data()),
            static_cast<std::streamsize>(strip.bytes.size()));
    return strip;
}

void write_exr(const Image& image, const fs::path& path) {
    std::vector<Imf::Rgba> pixels(image.size().pixels());
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const float* p = image.pixel(x, y);
            pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width()) +
                   static_cast<std::size_t>(x)] = Imf::Rgba(p[0], p[1], p[2]);
        }
    Imf::RgbaOutputFile file(path.c_str(), image.width(), image.height(), Imf::WRITE_RGB);
    file.setFrameBuffer(pixels.data(), 1, static_cast<std::size_t>(image.width()));
    file.writePixels(image.height());
}

// ---- kernels

/// What one would write with OpenCV: maps by formula for each face, then cv::remap.
void remapped(const cv::Mat& photo, int size, std::array<cv::Mat, 6>& faces) {
    const Cube cube;
    cv::Mat map_x(size, size, CV_32F), map_y(size, size, CV_32F);
    for (int face = 0; face < 6; ++face) {
        const Face& f = cube.layout().faces[static_cast<std::size_t>(face)];
        const V3d n = cube.layout().forward(face);
        using V3f = Imath::V3f;
        const V3f right(f.right), down(f.down), forward(n);
        for (int y = 0; y < size; ++y) {
            auto* to_x = map_x.ptr<float>(y);
            auto* to_y = map_y.ptr<float>(y);
            const V3f row =
                forward +
                down * (2 * (static_cast<float>(y) + 0.5F) / static_cast<float>(size) - 1);
            for (int x = 0; x < size; ++x) {
                V3f d = row +
                        right * (2 * (static_cast<float>(x) + 0.5F) / static_cast<float>(size) - 1);
                d *= 1 / std::sqrt(d.dot(d));
                const float k = 0.5F * kDiameter / std::sqrt(std::max(2 * (d.z + 1), 1e-12F));
                to_x[x] = 0.5F * kDiameter + k * d.x - 0.5F;
                to_y[x] = 0.5F * kDiameter - k * d.y - 0.5F;
            }
        }
        cv::remap(photo, faces[static_cast<std::size_t>(face)], map_x, map_y, cv::INTER_LINEAR,
                  cv::BORDER_REPLICATE);
    }
}

std::string v360(const fs::path& ball, const char* interpolation, int size, int frames) {
    // The photo is taken once and then looped: what a further frame costs is the filter alone.
    return fmt::format(
        "ffmpeg -v error -y -threads 1 -filter_threads 1 -i {} -vf "
        "loop={}:1,v360=ball:c6x1:interp={}:w={}:h={} -f null -",
        ball.string(), frames - 1, interpolation, 6 * size, size);
}

void compare_kernels(const Image& photo, const fs::path& folder, int size, int rounds) {
    const ThreadLimit one(1);
    const Source source = ball_source(photo, distant_ball(), {});
    const std::vector<Sample> samples = reference(source, size);
    const double pixels = 6.0 * size * size;
    const bool ffmpeg = installed("ffmpeg");
    const cv::Mat mat(kDiameter, kDiameter, CV_32FC3, const_cast<float*>(photo.row(0)));
    cv::setNumThreads(1);
    const Layout& layout = *find_layout("openexr");
    Image exact(layout.picture(size), 4), fast(layout.picture(size), 4);
    std::array<cv::Mat, 6> faces;
    const ResampleOptions fast_options{Filter::fast, {}};

    enum { kDefault, kFast, kRemap, kLinear, kCubic, kCount };
    std::array<std::vector<double>, kCount> cost;  // ns a pixel, round by round
    const auto add = [&](int who, double seconds) {
        cost[static_cast<std::size_t>(who)].push_back(1e9 * seconds / pixels);
    };
    constexpr int kFrames = 10;
    for (int round = 0; round < rounds; ++round) {
        add(kDefault, own_cpu_of([&] { resample(source, layout, exact.view()); }));
        add(kFast, own_cpu_of([&] { resample(source, layout, fast.view(), fast_options); }));
        add(kRemap, own_cpu_of([&] { remapped(mat, size, faces); }));
        if (!ffmpeg) continue;
        const fs::path ball = folder / "ball.ppm";
        for (const auto& [who, name] : {std::pair(kLinear, "linear"), std::pair(kCubic, "cubic")})
            add(who, (cost_of(v360(ball, name, size, kFrames + 1)).cpu -
                      cost_of(v360(ball, name, size, 1)).cpu) /
                         kFrames);
    }
    const auto from_image = [&](const Image& map) {
        return quality_of(samples, [&](const Sample& s) {
            const float* p = map.pixel(s.x, s.face * size + s.y);
            return V3d(p[0], p[1], p[2]);
        });
    };
    const auto from_strip = [&](const char* name) {
        const fs::path ball = folder / "ball.ppm", out = folder / "strip.ppm";
        cost_of(
            fmt::format("ffmpeg -v error -y -i {} -vf v360=ball:c6x1:interp={}:w={}:h={} "
                        "-pix_fmt rgb48be {}",
                        ball.string(), name, 6 * size, size, out.string()));
        return quality_of_strip(samples, read_ppm(out, size));
    };
    fmt::print("\n{}-px ball to six {}-px faces, one thread:\n\n", kDiameter, size);
    fmt::print("| | CPU ns/px | of the default filter's | PSNR to 150 degrees | beyond |\n");
    fmt::print("|---|---|---|---|---|\n");
    const auto row = [&](const char* name, int who, const Quality& quality) {
        const auto& own = cost[kDefault];
        const auto& theirs = cost[static_cast<std::size_t>(who)];
        std::vector<double> ratios;
        for (std::size_t i = 0; i < theirs.size(); ++i) ratios.push_back(theirs[i] / own[i]);
        fmt::print("| {} | {:.1f} | {:.2f} | {:.1f} | {:.1f} |\n", name, median(theirs),
                   median(ratios), quality.front, quality.rim);
    };
    row("chromeball", kDefault, from_image(exact));
    row("chromeball, fast", kFast, from_image(fast));
    row("cv::remap, bilinear, with its maps", kRemap, quality_of(samples, [&](const Sample& s) {
            const auto& p = faces[static_cast<std::size_t>(s.face)].at<cv::Vec3f>(s.y, s.x);
            return V3d(p[0], p[1], p[2]);
        }));
    if (!ffmpeg) return;
    row("ffmpeg v360, bilinear", kLinear, from_strip("linear"));
    row("ffmpeg v360, bicubic", kCubic, from_strip("cubic"));
}

// ---- whole processes

struct Peer {
    const char* name;
    std::vector<const char*> tools;
    std::string ours, theirs;
};

void compare_processes(const fs::path& folder, int rounds) {
    const std::string exr = (folder / "ball.exr").string(), png = (folder / "ball.png").string();
    const std::string out = (folder / "out").string();
    const auto ours = [&](const std::string& input, const char* layout, const char* extension) {
        return fmt::format(
            "{} convert {} --ball {},{},{} --orthographic --layout {} --size 1024 "
            "--input-space scene_linear --output-space scene_linear -o {}a.{}",
            CHROMEBALL_PROGRAM, input, kDiameter / 2, kDiameter / 2, kDiameter / 2, layout, out,
            extension);
    };
    std::vector<Peer> peers{
        {"ffmpeg v360, bilinear: PNG to a strip of faces, PNG",
         {"ffmpeg"},
         ours(png, "strip-h", "png"),
         fmt::format("ffmpeg -v error -y -i {} -vf v360=ball:c6x1:interp=linear:w=6144:h=1024 "
                     "-pix_fmt rgb48be {}b.png",
                     png, out)},
        {"pfspanoramic: EXR to a lat-long, EXR",
         {"pfsin", "pfspanoramic"},
         ours(exr, "latlong", "exr"),
         fmt::format("pfsin {} | pfspanoramic mirrorball+polar -i -w 2048 | pfsout {}b.exr", exr,
                     out)},
        {"pfspanoramic and exrenvmap: EXR to faces, EXR",
         {"pfsin", "exrenvmap"},
         ours(exr, "openexr", "exr"),
         fmt::format("pfsin {} | pfspanoramic mirrorball+polar -i -w 4096 | pfsout {}l.exr && "
                     "exrenvmap -li -c -w 1024 {}l.exr {}b.exr",
                     exr, out, out, out)}};
    fmt::print("\nWhole processes, in turn; times longer than chromeball:\n\n");
    fmt::print("| | wall | CPU | chromeball, s |\n|---|---|---|---|\n");
    for (const Peer& peer : peers) {
        if (!std::all_of(peer.tools.begin(), peer.tools.end(), installed)) continue;
        if (peer.tools[0] == std::string("ffmpeg") && !fs::exists(png))
            cost_of(fmt::format("ffmpeg -v error -y -i {} -pix_fmt rgb48be {}",
                                (folder / "ball.ppm").string(), png));
        std::vector<double> wall, cpu, seconds;
        for (int round = 0; round < rounds; ++round) {
            const Cost own = cost_of(peer.ours), other = cost_of(peer.theirs);
            wall.push_back(other.wall / own.wall);
            cpu.push_back(other.cpu / own.cpu);
            seconds.push_back(own.wall);
        }
        fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} |\n", peer.name, median(wall), median(cpu),
                   median(seconds));
    }
}

int run(int rounds) {
    const fs::path folder =
        fs::temp_directory_path() / fmt::format("chromeball-bench-{}", getpid());
    fs::create_directories(folder);
    const Image photo = painted_ball();
    write_ppm(photo, folder / "ball.ppm");
    write_exr(photo, folder / "ball.exr");
    for (const int size : {1024, 512}) {
        compare_kernels(photo, folder, size, rounds);
        std::fflush(stdout);
    }
    std::fflush(stdout);
    compare_processes(folder, rounds);
    fs::remove_all(folder);
    return 0;
}

}  // namespace
}  // namespace chromeball

// Rounds: how often each is run, 5 if not told.
int main(int count, char** words) { return chromeball::run(count > 1 ? std::atoi(words[1]) : 5); }
