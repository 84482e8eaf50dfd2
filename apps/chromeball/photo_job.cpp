#include "photo_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "io/facts.h"
#include "io/read.h"
#include "map/layouts.h"
#include "numbers.h"
#include "refuse.h"
#include "resample/source.h"

namespace chromeball {
namespace {

using std::numbers::pi;

/// How far an outline reaches beyond the picture, as a part of its own width and height.
V2d beyond_edges(const Outline& e, Size picture) {
    const double c = std::cos(e.angle * pi / 180), s = std::sin(e.angle * pi / 180);
    const V2d half(std::hypot(e.a * c, e.b * s), std::hypot(e.a * s, e.b * c));
    return {std::max({0.0, half.x - e.cx, e.cx + half.x - picture.width}) / (2 * half.x),
            std::max({0.0, half.y - e.cy, e.cy + half.y - picture.height}) / (2 * half.y)};
}

void check_inside(const Outline& e, const Photo& photo, const std::string& option) {
    // Far more than a close-up of a part of a ball; what is typed so is a slip.
    const double most = 100.0 * std::max(photo.display.width, photo.display.height);
    if (e.a > most || e.b < 0.5)
        refuse(
            fmt::format("{}: {} is no ball in a picture of {}x{} pixels: its radius must be from "
                        "half a pixel to 100 times the picture",
                        photo.name, option, photo.display.width, photo.display.height));
    const V2d beyond = beyond_edges(e, photo.display);
    const Window window = needed_window(e, photo.window);
    if (beyond.x < 1 && beyond.y < 1 && window.size.width > 0 && window.size.height > 0) return;
    refuse(fmt::format("{}: {} lies outside the picture, which is {}x{} pixels", photo.name, option,
                       photo.display.width, photo.display.height));
}

/// The ball of a photo that was cut out around it.
FoundBall cropped_ball(const Photo& photo, const PhotoOptions& options) {
    FoundBall ball;
    ball.found = true;
    ball.how = "--cropped";
    const auto past = provenance_from(photo.metadata);
    // Its camera describes the whole photo; one given here too.
    if (past && past->layout == "crop" && past->outline &&
        photo.display.width == photo.display.height && !options.orthographic) {
        ball.outline = *past->outline;
        ball.to_pixels = crop_of(ball.outline, photo.display.width);
        return ball;
    }
    const double rx = 0.5 * photo.display.width, ry = 0.5 * photo.display.height;
    ball.outline = {rx, ry, std::max(rx, ry), std::min(rx, ry), ry > rx ? 90.0 : 0.0};
    return ball;
}

/// A crop remembers the camera of the whole photo; without such a note it is as seen from far away.
void adopt_camera_of_crop(PhotoJob& job, const PhotoOptions& options) {
    const auto past = provenance_from(job.photo.metadata);
    const bool whole_known = past && past->outline && job.ball.outline == *past->outline;
    if (!whole_known) {
        if (!job.camera.told) {
            job.camera.source = "--cropped: orthographic";
            job.camera.told = true;
        }
        return;
    }
    if (!past->camera) return;
    Camera& camera = job.camera.camera;
    if (!options.principal) camera.principal = past->camera->principal;
    if (!job.camera.told && past->camera->focal) {
        camera.focal = past->camera->focal;
        camera.distortion = past->camera->distortion;
        job.camera.source = "noted in the crop";
        job.camera.told = true;
    }
}

/// Where nobody tells the lens, an outline that is clearly longer than wide does.
void adopt_camera_of_outline(PhotoJob& job) {
    const bool cropped = !job.camera.note.empty();  // the optical axis may be anywhere
    if (job.camera.told || cropped || !job.ball.found || !job.ball.candidate->focal) return;
    const FocalEstimate& estimate = *job.ball.candidate->focal;
    job.camera.camera.focal = estimate.focal;
    job.camera.deviation = estimate.deviation;
    job.camera.source = "estimated from the outline";
    job.camera.told = true;
    job.warnings.push_back(fmt::format(
        "{}: the focal length is not known; the outline's shape says {:.0f} pixels, give or take "
        "{:.0f}, if the picture is not cropped: give --focal-mm and --sensor-mm, --hfov, "
        "--focal-px or --distance-radii if you know better, or --orthographic",
        job.photo.name, estimate.focal, estimate.deviation));
}

FoundBall told_ball(const Photo& photo, const PhotoOptions& options) {
    FoundBall ball;
    ball.found = true;
    ball.circle_given = options.ball.has_value();
    ball.how = options.ball ? "--ball" : "--ellipse";
    ball.outline = options.ball
                       ? parse_outline("--ball", *options.ball, {3}, "CX,CY,R")
                       : parse_outline("--ellipse", *options.ellipse, {5}, "CX,CY,A,B,DEG");
    check_inside(ball.outline, photo,
                 fmt::format("{} {}", ball.how, options.ball ? *options.ball : *options.ellipse));
    return ball;
}

FoundBall searched_ball(const Photo& photo, const CameraChoice& camera, const PhotoOptions& options,
                        const Watch& watch) {
    FoundBall ball;
    ball.how = "found";
    const auto candidates = find_balls(photo, search_options(options, camera), watch);
    if (candidates.empty()) return ball;
    ball.candidate = candidates.front();
    ball.others.assign(candidates.begin() + 1, candidates.end());
    ball.outline = candidates.front().outline;
    ball.found = candidates.front().confidence >= options.threshold;
    return ball;
}

}  // namespace

Outline parse_outline(std::string_view option, std::string_view value,
                      std::initializer_list<std::size_t> counts, std::string_view form) {
    const auto n = parse_numbers(option, value, counts, form);
    const bool circle = n.size() == 3;
    Outline e{n[0], n[1], n[2], circle ? n[2] : n[3], circle ? 0 : n[4]};
    if (!(e.a > 0 && e.b > 0))
        refuse(fmt::format("{} {}: the {} must be above 0", option, value,
                           circle ? "radius" : "semi-axes"));
    if (e.a < e.b) {
        std::swap(e.a, e.b);
        e.angle += 90;
    }
    e.angle = std::fmod(std::fmod(e.angle, 180) + 180, 180);
    return e;
}

std::string unknown_lens_warning(const std::string& name, std::string_view more) {
    return fmt::format(
        "{}: the focal length is not known, the camera is taken as infinitely far away; directions "
        "may be off by degrees: give --focal-mm and --sensor-mm, --hfov, --focal-px{} or "
        "--distance-radii",
        name, more);
}

Outline told_outline(const Photo& photo, const PhotoOptions& options) {
    return told_ball(photo, options).outline;
}

DetectOptions search_options(const PhotoOptions& options, const CameraChoice& camera) {
    DetectOptions search;
    search.threshold = options.threshold;
    // Seen through a lens that distorts, the rim is no cone's ellipse: it is fitted freely then.
    if (camera.camera.distortion.none()) search.camera = camera.camera;
    if (options.near) {
        const auto n = parse_numbers("--near", *options.near, {2}, "X,Y");
        search.near = V2d(n[0], n[1]);
    }
    if (options.radius_range) {
        const auto n = parse_numbers("--radius-range", *options.radius_range, {2}, "MIN,MAX");
        if (!(n[0] >= 0 && n[1] > n[0]))
            refuse(fmt::format("--radius-range {}: expected MIN,MAX with 0 <= MIN < MAX",
                               *options.radius_range));
        search.radius_range = {n[0], n[1]};
    }
    return search;
}

PhotoJob open_photo(const std::string& path, const PhotoOptions& options, const Watch& watch,
                    bool put_off) {
    const int ways = options.ball.has_value() + options.ellipse.has_value() + options.cropped;
    if (ways > 1) refuse("more than one of --ball, --ellipse and --cropped; give one");

    PhotoJob job;
    ReadOptions read{.max_pixels = options.max_pixels};
    const bool told = options.ball || options.ellipse;
    if (told && !options.all_rows) {
        job.photo = read_header(path, read);
        const FoundBall ball = told_ball(job.photo, options);
        const Window rows = needed_window(ball.outline, job.photo.window);
        read.rows = std::pair(rows.y, rows.y + rows.size.height);
        job.photo.window.y = rows.y;
        job.photo.window.size.height = rows.size.height;
    }
    if (told && put_off && !options.all_rows)
        job.unread = read;
    else
        job.photo = read_photo(path, read);
    if (!job.photo.damage.empty()) job.warnings.push_back(damage_warning(job.photo));
    watch.check();
    job.camera = choose_camera(options, job.photo);
    if (told) {
        job.ball = told_ball(job.photo, options);
    } else if (options.cropped) {
        job.ball = cropped_ball(job.photo, options);
        adopt_camera_of_crop(job, options);
    } else {
        job.ball = searched_ball(job.photo, job.camera, options, watch);
        adopt_camera_of_outline(job);
    }
    if (job.ball.found && !options.cropped) {
        const V2d beyond = beyond_edges(job.ball.outline, job.photo.display);
        if (std::max(beyond.x, beyond.y) > 0.01)  // more than an error of the outline
            job.warnings.push_back(
                fmt::format("{}: the ball is partly outside the picture; what is mirrored there "
                            "stays empty (alpha 0)",
                            path));
    }
    if (!job.camera.note.empty() && job.ball.found) job.warnings.push_back(job.camera.note);
    if (!job.camera.told && job.ball.found) job.warnings.push_back(unknown_lens_warning(path));
    return job;
}

std::string damage_warning(const Photo& photo) {
    return fmt::format(
        "{}: is damaged ({}); parts of the picture may be wrong: copy or export it again",
        photo.name, photo.damage);
}

Error no_ball(const PhotoJob& job, double threshold) {
    const std::string best = job.ball.candidate
                                 ? fmt::format("best candidate scores {:.2f}, {:.2f} is needed",
                                               job.ball.candidate->confidence, threshold)
                                 : std::string("nothing round was seen");
    std::string way_out = "give it with --ball CX,CY,R or --cropped";
    const auto past = provenance_from(job.photo.metadata);
    if (past && find_layout(past->layout))
        way_out = fmt::format("it is a map: convert it with --from {}", past->layout);
    return {Error::Kind::no_ball,
            fmt::format("{}: no mirror ball found ({}{}); {}", job.photo.name, best,
                        job.photo.damage.empty() ? "" : "; the file is damaged", way_out)};
}

Image drawn_image(const Photo& picture) {
    Image image(picture.window.size, 3);
    const auto* values = reinterpret_cast<const unsigned char*>(picture.pixels.data());
    std::transform(values, values + picture.window.size.pixels() * 3, image.row(0),
                   [](unsigned char value) { return static_cast<float>(value) / 255; });
    return image;
}

double lens_blur(const Candidate& candidate) {
    // A sharp edge seen by square pixels has a blur of about half a pixel.
    constexpr double kPixel = 0.5;
    return std::sqrt(std::max(0.0, candidate.rim_blur * candidate.rim_blur - kPixel * kPixel));
}

double lens_blur(const PhotoJob& job) {
    return job.ball.candidate ? lens_blur(*job.ball.candidate) : 0;
}

MirrorBall projection_of(PhotoJob& job) {
    const Outline& outline = job.ball.outline;
    if (job.camera.distance) {
        job.camera.camera.focal =
            focal_from_distance(outline, job.camera.camera.principal, *job.camera.distance);
        if (!job.camera.camera.focal)
            refuse(
                fmt::format("--distance-radii {}: no focal length makes this outline that of a "
                            "ball so far away",
                            *job.camera.distance));
    }
    if (job.camera.camera.orthographic()) return MirrorBall(outline);

    const Cone cone = cone_of(outline, job.camera.camera);
    const auto seen = outline_of(cone, job.camera.camera);
    if (!(cone.half_angle > 0 && cone.half_angle < 0.5 * pi * 0.999) || !seen)
        refuse(
            fmt::format("{}: the outline cannot be that of a ball seen with a focal length of "
                        "{:.1f} pixels; check "
                        "the focal length, or give --orthographic",
                        job.photo.name, *job.camera.camera.focal));
    const double off = rim_deviation(outline, *seen);
    if (off > 1)
        job.warnings.push_back(
            job.ball.circle_given
                ? fmt::format(
                      "{}: seen off the optical axis the ball is an ellipse; the circle given is "
                      "up to {:.1f} pixels "
                      "off it. The best fit is used: --ellipse {:.2f},{:.2f},{:.2f},{:.2f},{:.2f}",
                      job.photo.name, off, seen->cx, seen->cy, seen->a, seen->b, seen->angle)
                : fmt::format("{}: the outline is up to {:.1f} pixels off what a ball looks like "
                              "through this camera "
                              "({}); check the focal length and whether the photo is cropped",
                              job.photo.name, off, job.camera.source));
    return MirrorBall(job.camera.camera, cone);
}

std::string description(const PhotoJob& job, const MirrorBall& ball) {
    const Outline& e = ball.outline();
    std::string line = fmt::format("{}: ball {}{}", job.photo.name,
                                   job.ball.candidate ? "" : "given by ", job.ball.how);
    if (job.ball.candidate)
        line += fmt::format(" with confidence {:.2f}", job.ball.candidate->confidence);
    line += fmt::format(", --ellipse {:.2f},{:.2f},{:.2f},{:.2f},{:.2f}", e.cx, e.cy, e.a, e.b,
                        e.angle);
    if (ball.orthographic()) return line + ", orthographic";
    return line +
           fmt::format("; --focal-px {:.2f} ({}), {:.2f} radii away, hidden cone {:.2f} degrees",
                       *job.camera.camera.focal, job.camera.source, ball.distance(),
                       ball.hidden_half_angle() * 180 / pi);
}

MirrorBall seen_ball(PhotoJob& job, double threshold, const Console& console) {
    if (!job.ball.found) throw no_ball(job, threshold);
    const MirrorBall ball = projection_of(job);
    for (const std::string& warning : job.warnings) console.warn(warning);
    console.say(description(job, ball));
    return ball;
}

}  // namespace chromeball
