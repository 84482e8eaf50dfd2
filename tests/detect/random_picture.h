#pragma once

#include <functional>
#include <string>
#include <vector>

#include "detect/dice.h"
#include "detect/random_world.h"

namespace chromeball::painted {

/// A picture and what is in it.
struct RandomPicture {
    Photo photo;
    std::vector<Outline> balls;  ///< mirror balls; none where what is there is something else
    std::string kind;            ///< of the main thing
};

/// Linear light, or what covers it: premultiplied colour and coverage.
struct Canvas {
    Size size;
    std::vector<V3f> color;
    std::vector<float> cover;

    explicit Canvas(Size s) : size(s), color(s.pixels(), V3f(0)), cover(s.pixels(), 0) {}
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * std::size_t(size.width) + std::size_t(x);
    }
    /// Lays a colour over a pixel.
    void add(int x, int y, V3d light, double alpha) {
        const auto a = static_cast<float>(alpha);
        const std::size_t i = at(x, y);
        color[i] = color[i] * (1 - a) + V3f(light) * a;
        cover[i] = cover[i] * (1 - a) + a;
    }
    void lay_over(const Canvas& layer) {
        for (std::size_t i = 0; i < color.size(); ++i)
            if (layer.cover[i] > 0) {
                color[i] = color[i] * (1 - layer.cover[i]) + layer.color[i];
                cover[i] = cover[i] * (1 - layer.cover[i]) + layer.cover[i];
            }
    }
    /// Box along x and y, `radius` pixels to each side (0.5: [1 2 1] / 4), in place.
    void blur(double radius) {
        for (const bool down : {false, true}) {
            const int n = down ? size.height : size.width, m = down ? size.width : size.height;
            const int reach = static_cast<int>(std::ceil(radius));
            const double edge = radius - reach + 1, total = 2 * reach - 1 + 2 * edge;
            using Sum = Imath::Vec4<double>;
            std::vector<Sum> line(static_cast<std::size_t>(n + 2 * reach)), sums(line.size() + 1);
            for (int j = 0; j < m; ++j) {
                const auto index = [&](int i) { return down ? at(j, i) : at(i, j); };
                for (int i = 0; i < n + 2 * reach; ++i) {
                    const std::size_t from = index(std::clamp(i - reach, 0, n - 1));
                    const V3f c = color[from];
                    line[std::size_t(i)] = Sum(c.x, c.y, c.z, cover[from]);
                    sums[std::size_t(i) + 1] = sums[std::size_t(i)] + line[std::size_t(i)];
                }
                for (int i = 0; i < n; ++i) {
                    const auto first = static_cast<std::size_t>(i);
                    const auto last = static_cast<std::size_t>(i + 2 * reach);
                    const Sum mean =
                        (sums[last] - sums[first + 1] + (line[first] + line[last]) * edge) / total;
                    color[index(i)] = V3f(V3d(mean.x, mean.y, mean.z));
                    cover[index(i)] = static_cast<float>(mean.w);
                }
            }
        }
    }
    /// What a shutter open for a straight way of (dx, dy) pixels sees, the middle in place.
    void smear(double dx, double dy) {
        const Canvas still = *this;
        const int steps = std::max(2, static_cast<int>(std::ceil(1.5 * std::hypot(dx, dy))));
        std::fill(color.begin(), color.end(), V3f(0));
        std::fill(cover.begin(), cover.end(), 0.f);
        for (int k = 0; k < steps; ++k) {
            const double t = (k + 0.5) / steps - 0.5, sx = t * dx, sy = t * dy;
            const int ix = static_cast<int>(std::floor(sx)), iy = static_cast<int>(std::floor(sy));
            const auto u = static_cast<float>(sx - ix), v = static_cast<float>(sy - iy);
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    const float w = (i ? u : 1 - u) * (j ? v : 1 - v) / static_cast<float>(steps);
                    if (w > 0) add_shifted(still, ix + i, iy + j, w);
                }
        }
    }

private:
    void add_shifted(const Canvas& from, int dx, int dy, float weight) {
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x) {
                const std::size_t source = from.at(std::clamp(x - dx, 0, size.width - 1),
                                                   std::clamp(y - dy, 0, size.height - 1));
                color[at(x, y)] += from.color[source] * weight;
                cover[at(x, y)] += from.cover[source] * weight;
            }
    }
};

/// An ellipse to be filled.
struct Patch2d {
    Outline o;
    /// (u, v) of the unit disk; v down.
    V2d local(double x, double y) const {
        const double c = std::cos(o.angle * std::numbers::pi / 180);
        const double s = std::sin(o.angle * std::numbers::pi / 180);
        return {(c * (x - o.cx) + s * (y - o.cy)) / o.a, (c * (y - o.cy) - s * (x - o.cx)) / o.b};
    }
};

/// One random picture in the making.
class Studio {
public:
    Studio(unsigned number, double smallest, double largest, bool all_moving)
        : least_radius_(std::min(48.0, 0.3 * smallest)),
          all_moving_(all_moving),
          dice_(number),
          canvas_(Size{}),
          number_(number) {
        const int longest = static_cast<int>(dice_.log_uniform(smallest, largest));
        const int shortest = longest * dice_.whole(70, 100) / 100;
        size_ = dice_.chance(0.2) ? Size{shortest, longest} : Size{longest, shortest};
        canvas_ = Canvas(size_);
    }

    RandomPicture made() {
        choose_place();
        paint_background();
        RandomPicture picture;
        picture.kind = kind_;
        const double moves =
            hard_ == moving ? dice_.log_uniform(all_moving_ ? 0.06 : 0.03, 0.3) * radius_ : 0;
        const double heading = dice_.uniform(0, 6.2832);
        const double most = kind_ == "crowd" ? 24 : 4;
        if (kind_ == "crowd" || dice_.chance(0.35))
            for (int i = dice_.whole(1, int(most)); i > 0; --i) clutter(picture, 0.7);
        const bool all_move = dice_.chance(all_moving_ ? 0.2 : 0.4);
        Canvas layer(size_);
        draw_thing(layer, kind_, centre_, outline());
        if (kind_ == "mirror") picture.balls.push_back(outline());
        if (dice_.chance(0.5)) stand(layer);
        if (moves > 0 && !all_move)
            layer.smear(moves * std::cos(heading), moves * std::sin(heading));
        canvas_.lay_over(layer);
        if (hard_ == hidden && dice_.chance(0.7))
            occluder();
        else if (hard_ == hidden)
            clutter(picture, 0.3);
        if (moves > 0 && all_move)
            canvas_.smear(moves * std::cos(heading), moves * std::sin(heading));
        if (moves > 0) picture.kind += "-moving";
        picture.photo = photographed();
        return picture;
    }

private:
    double f() const { return *camera_.focal; }
    Outline outline_at(V3d centre) const {
        return outline_of(Cone{centre.normalized(), std::asin(1 / centre.length())}, camera_)
            .value_or(Outline{0, 0, 1, 1, 0});
    }
    Outline outline() const { return outline_at(centre_); }
    V3d ray(double x, double y) const {
        return V3d((x - camera_.principal.x) / f(), (camera_.principal.y - y) / f(), -1)
            .normalized();
    }
    V3d place(double x, double y, double distance) const {
        return V3d((x - camera_.principal.x) / f(), (camera_.principal.y - y) / f(), -1) * distance;
    }
    /// From the camera's frame to the surroundings'.
    V3d turned(V3d d) const { return {d.dot(rows_[0]), d.dot(rows_[1]), d.dot(rows_[2])}; }

    void choose_place() {
        // Most of the negatives are of the kinds that are hard to tell from a mirror.
        static const char* kinds[] = {"matte",  "rough",   "rough",   "rough",   "glossy",
                                      "glossy", "painted", "painted", "painted", "planet",
                                      "disc",   "disc",    "wheel",   "plate",   "lens",
                                      "moon",   "ring",    "picture", "nothing", "nothing",
                                      "wall",   "wall",    "wall",    "crowd",   "crowd"};
        kind_ = dice_.chance(0.5) ? "mirror" : kinds[dice_.whole(0, 24)];
        hard_ = static_cast<Hard>(dice_.whole(0, 11));  // six of twelve: none
        if (all_moving_) hard_ = moving;
        const auto [w, h] = size_;
        const double longest = std::max(w, h);
        if (dice_.chance(0.5)) plate_ = plates()[static_cast<std::size_t>(dice_.whole(0, 3))].get();
        if (plate_) {
            const bool left = dice_.chance(0.5);
            const auto strip = plate_->strip(left);
            const Size whole = plate_->size();
            const double most = std::min((strip[1] - strip[0]) / w, double(whole.height) / h);
            scale_ = most * dice_.uniform(0.6, 1);
            left_ = dice_.uniform(strip[0], strip[1] - scale_ * w);
            top_ = dice_.uniform(0, whole.height - scale_ * h);
            flip_ = dice_.chance(0.5);
            environment_ = &plate_->environment();
            const Camera& c = plate_->camera();
            double px = (c.principal.x - left_) / scale_;
            if (flip_) px = w - px, rows_[0].x = -1;
            camera_ = {*c.focal / scale_, {px, (c.principal.y - top_) / scale_}};
        } else {
            // Fifty pictures in the same surroundings, seen from all sides.
            environment_ = &surroundings(10 * (number_ / 1000) + unsigned(dice_.whole(0, 9)));
            camera_ = {dice_.log_uniform(0.75, 3.5) * longest, {0.5 * w, 0.5 * h}};
            const double yaw = dice_.uniform(0, 6.2832), pitch = dice_.uniform(-0.45, 0.2);
            const double roll = dice_.chance(0.2) ? dice_.uniform(-0.5, 0.5) : 0;
            const V3d back(std::sin(yaw) * std::cos(pitch), -std::sin(pitch),
                           std::cos(yaw) * std::cos(pitch));
            const V3d level(std::cos(yaw), 0, -std::sin(yaw));
            const V3d up = back.cross(level);
            const V3d right = level * std::cos(roll) + up * std::sin(roll);
            const V3d top = up * std::cos(roll) - level * std::sin(roll);
            for (int k = 0; k < 3; ++k) rows_[std::size_t(k)] = V3d(right[k], top[k], back[k]);
        }
        for (int attempt = 0; attempt < 20; ++attempt) {
            const double largest = (attempt < 10 ? 0.48 : 0.3) * std::min(w, h);
            radius_ = hard_ == small ? dice_.log_uniform(12, 40)
                                     : dice_.log_uniform(least_radius_,
                                                         std::max(1.125 * least_radius_, largest));
            // Most near the middle.
            const double where = dice_.uniform(0, 1);
            const double off = hard_ == cut  ? -0.4 * radius_ / std::min(w, h)
                               : where < 0.7 ? 0.5 * (1 - 1 / 3.0)
                                             : 1.02 * radius_ / std::min(w, h);
            const double x = w * dice_.uniform(std::min(off, 0.5), std::max(1 - off, 0.5));
            const double y = h * dice_.uniform(std::min(off, 0.5), std::max(1 - off, 0.5));
            centre_ = place(x, y, f() / radius_);
            if (centre_.length() < 1.8) continue;
            const Outline o = outline();
            if (o.b > 0.8 * o.a && std::hypot(o.cx - x, o.cy - y) < o.a) break;
        }
        up_ = V3d(rows_[1].x, rows_[1].y, rows_[1].z);
        if (dice_.chance(plate_ ? 0.1 : 0.25)) {
            table_ = Texture::random(dice_);
            table_->pitch *= 3;
            below_ = dice_.chance(0.5) ? 1 : dice_.uniform(1, 4);
            reach_ = dice_.log_uniform(2.5, 40);
        }
        dirt_ = dice_.chance(0.25) ? dice_.uniform(0, 0.2) : 0;
        reflectance_ =
            V3d(1, dice_.uniform(0.85, 1), dice_.uniform(0.7, 1)) * dice_.log_uniform(0.5, 0.95);
        if (dice_.chance(0.5)) reflectance_ = V3d(reflectance_.x);
        cloth_ = dice_.color(0.5) * 0.5;
        person_ = dice_.chance(0.6) ? dice_.log_uniform(0.15, 1.0) : 0;
        grain_ = dice_.chance(0.3) ? dice_.log_uniform(0.05, 0.4) : 0;
    }

    /// The table under the ball, if a ray from `p` meets it.
    std::optional<V3d> table_light(V3d p, V3d d) const {
        if (!table_) return std::nullopt;
        const double fall = d.dot(up_);
        if (fall > -1e-4) return std::nullopt;
        const double t = ((centre_ - p).dot(up_) - below_) / fall;
        if (t < 0) return std::nullopt;
        const V3d q = p + d * t - centre_;
        const V3d across = V3d(1, 0, 0) - up_ * up_.x;
        const double u = q.dot(across.normalized()), v = q.dot(up_.cross(across).normalized());
        if (std::max(std::abs(u), std::abs(v)) > reach_) return std::nullopt;
        const double shadow = 1 - 0.75 * std::exp(-(u * u + v * v) / (0.6 + 0.3 * below_ * below_));
        const double speck =
            grain_ > 0 ? std::exp(3.4 * grain_ * (hash(int(u * 1e4), int(v * 1e4), 3) - 0.5)) : 1.0;
        return table_->at(u, v, 2) * environment_->rough(turned(up_), 50) * shadow * speck;
    }

    /// What comes to the point `p` near the ball from direction d.
    V3d incoming(V3d p, V3d d, double width) const {
        if (const auto light = table_light(p, d)) return *light;
        return environment_->sharp(turned(d), width);
    }

    /// The photographer, in the direction of the camera.
    bool photographer(V3d d) const {
        if (person_ == 0) return false;
        const V3d to = -centre_.normalized();
        const double z = d.dot(to);
        if (z < 0.2) return false;
        const double y = (d.dot(up_) - z * to.dot(up_)) / z / person_;
        const double x = (d - to * z - up_ * d.dot(up_)).length() / z / person_;
        return (x < 0.25 && y < 0.15 && y > -1.5) || std::hypot(x, (y - 0.3) / 1.3) < 0.12;
    }

    void paint_background() {
        const double soft = dice_.chance(0.3) ? dice_.log_uniform(0.3, 0.02 * size_.width) : 0;
        for (int y = 0; y < size_.height; ++y)
            for (int x = 0; x < size_.width; ++x) {
                const double px = x + 0.5, py = y + 0.5;
                canvas_.color[canvas_.at(x, y)] =
                    V3f(plate_ ? plate_->at(left_ + scale_ * (flip_ ? size_.width - px : px),
                                            top_ + scale_ * py, scale_)
                               : environment_->sharp(turned(ray(px, py)), 1 / f()));
            }
        if (kind_ == "wall" || dice_.chance(0.1)) paint_wall();
        if (soft > 0)
            for (int pass = 0; pass < 2; ++pass) canvas_.blur(soft);
        if (!table_) return;
        for (int y = 0; y < size_.height; ++y)
            for (int x = 0; x < size_.width; ++x)
                for (int k = 0; k < 2; ++k)
                    if (const auto c =
                            table_light(V3d(0), ray(x + 0.25 + 0.5 * k, y + 0.75 - 0.5 * k)))
                        canvas_.add(x, y, *c,
                                    k == 0                                ? 0.5
                                    : canvas_.cover[canvas_.at(x, y)] > 0 ? 1
                                                                          : 0.5);
    }

    /// A papered or brick wall behind everything.
    void paint_wall() {
        Texture paper = Texture::random(dice_);
        paper.kind = dice_.chance(0.5) ? Texture::bricks : paper.kind;
        paper.pitch *= 1.5;
        const double scale = dice_.log_uniform(0.2, 2) / radius_, slant = dice_.uniform(-0.4, 0.4);
        const V3d light = ambient();
        for (int y = 0; y < size_.height; ++y)
            for (int x = 0; x < size_.width; ++x) {
                const double near = 1 + slant * (x - 0.5 * size_.width) / size_.width;
                V3d sum(0);
                for (int k = 0; k < 2; ++k)
                    sum += paper.at((x + 0.25 + 0.5 * k) * scale / near,
                                    (y + 0.75 - 0.5 * k) * scale / near, 2);
                canvas_.color[canvas_.at(x, y)] = V3f(sum / 2 * light * grain());
            }
    }

    template <class Color>
    void fill(Canvas& to, const Outline& o, const Color& color, double softness = 1) {
        const Patch2d patch{o};
        const double reach = o.a + 2;
        for (int y = std::max(0, int(o.cy - reach));
             y < std::min<double>(size_.height, o.cy + reach); ++y)
            for (int x = std::max(0, int(o.cx - reach));
                 x < std::min<double>(size_.width, o.cx + reach); ++x) {
                const V2d p = patch.local(x + 0.5, y + 0.5);
                const double rho = p.length();
                // Distance to the rim: rho - 1 over its gradient.
                const double slope = std::hypot(p.x / o.a, p.y / o.b) / std::max(rho, 1e-9);
                const double alpha = std::clamp(0.5 - (rho - 1) / slope / softness, 0.0, 1.0);
                if (alpha > 0) to.add(x, y, color(x, y), alpha);
            }
    }

    /// A ball whose surface is given by normal, mirrored direction, place and the sample's width in
    /// the mirrored world.
    template <class Surface>
    void fill_ball(Canvas& to, V3d centre, const Outline& o, const Surface& surface,
                   double kind_of_grain = 1) {
        const Patch2d patch{o};
        fill(to, o, [&](int x, int y) {
            const double rho = patch.local(x + 0.5, y + 0.5).length();
            const int n = rho > 0.95 ? 4 : rho > 0.8 ? 3 : rho > 0.5 ? 2 : 1;
            const double width = 2 / (o.b * n);  // of what one sample stands for, mirrored
            V3d sum(0);
            for (int k = 0; k < n * n; ++k) {
                const V3d q = ray(x + (k % n + 0.5) / n, y + (k / n + 0.5) / n);
                const double along = q.dot(centre);
                const double room = std::max(0.0, along * along - centre.length2() + 1);
                const V3d p = q * (along - std::sqrt(room));
                const V3d normal = (p - centre).normalized();
                sum += surface(normal, q - normal * (2 * q.dot(normal)), p, width);
            }
            return sum / (n * n) * grain(kind_of_grain);
        });
    }

    /// A part of a disk at unit coordinates.
    template <class Color>
    void fill_disk(Canvas& to, const Outline& o, const Color& color) {
        const Patch2d patch{o};
        fill(to, o, [&](int x, int y) {
            V3d sum(0);
            for (int k = 0; k < 9; ++k)
                sum += color(patch.local(x + (k % 3 + 0.5) / 3, y + (k / 3 + 0.5) / 3));
            return sum / 9;
        });
    }

    /// What a renderer in a hurry, or a rough coat, makes of an even surface.
    double grain(double part = 1) {
        return grain_ * part > 0 ? std::exp(grain_ * part * dice_.normal()) : 1.0;
    }

    V3d ambient() const { return environment_->rough(turned(V3d(0, 0, 1)), 50); }

    Outline tilted(const Outline& o) {
        if (dice_.chance(0.5)) return {o.cx, o.cy, o.a, o.a, 0};
        return {o.cx, o.cy, o.a, o.a * dice_.uniform(0.75, 1), dice_.uniform(0, 180)};
    }

    void draw_thing(Canvas& to, const std::string& kind, V3d centre, const Outline& o) {
        const V3d paint = dice_.color(0.7), other = dice_.color(0.7);
        const V3d axis = dice_.direction(), aside = axis.cross(dice_.direction()).normalized();
        const V3d third = axis.cross(aside);
        const double a = dice_.uniform(0, 1), b = dice_.uniform(0, 1), c = dice_.uniform(0, 1);
        const V3d shift(99 * a, 99 * b, 99 * c);
        const auto matte = [&](V3d n) { return environment_->rough(turned(n), 50); };
        const auto pattern = [&](V3d n) {
            const V3d m(n.dot(aside), n.dot(axis), n.dot(third));
            const double lon = std::atan2(m.x, m.z) / std::numbers::pi;
            const double lat = std::asin(std::clamp(m.y, -1.0, 1.0)) / std::numbers::pi;
            const int cells = 2 + static_cast<int>(8 * a);
            if (b < 0.45)
                return (int(std::floor(lon * cells) + std::floor(lat * cells * 2)) & 1) ? paint
                                                                                        : other;
            if (b < 0.55) return (int(std::floor(lat * 2 * cells)) & 1) ? paint : other;
            if (b < 0.7)
                return fractal_noise(m * (1 + 5 * c) + shift, 5, 0.6) > 0.5 ? paint : other;
            if (b < 0.8) {  // seams, as on a ball for games
                const double seam = std::min(
                    {std::abs(m.x), std::abs(m.y), std::abs(m.z - 0.5), std::abs(m.z + 0.5)});
                return seam < 0.04 ? other * 0.2 : paint;
            }
            const double cell =
                hash(int(std::floor(lon * 3 * cells)), int(std::floor(lat * 3 * cells)), 3);
            return paint * cell + other * (1 - cell);
        };
        if (kind == "mirror") {
            const double fine = dirt_ > 0 ? dice_.log_uniform(3, 60) : 0;
            return fill_ball(
                to, centre, o,
                [&](V3d n, V3d r, V3d p, double width) {
                    V3d light = (photographer(r) ? cloth_ * ambient() : incoming(p, r, width)) *
                                reflectance_;
                    if (dirt_ > 0) {
                        const double spot =
                            dirt_ *
                            std::clamp(4 * fractal_noise(n * fine + shift, 3) - 1.9, 0.0, 1.0);
                        light = light * (1 - spot) + matte(n) * 0.3 * spot;
                    }
                    return light;
                },
                0);
        }
        if (kind == "matte")
            return fill_ball(to, centre, o,
                             [&](V3d n, V3d, V3d, double) { return paint * matte(n); });
        if (kind == "rough") {
            const double lobe = dice_.log_uniform(3.5, 40);
            const int rays = lobe < 8 || dice_.chance(0.5) ? dice_.whole(2, 12) : 0;
            const V3d metal = dice_.chance(0.5) ? V3d(0.8) : V3d(0.9, 0.7, 0.4);
            return fill_ball(to, centre, o, [&](V3d n, V3d r, V3d p, double width) {
                const auto table = table_light(p, r);
                if (rays == 0)
                    return metal *
                           (table && lobe < 15 ? *table : environment_->rough(turned(r), lobe));
                // A few rays a pixel, as a renderer that is in a hurry.
                V3d sum(0);
                const double spread = std::tan(lobe * std::numbers::pi / 180);
                for (int k = 0; k < rays; ++k) {
                    V3d d = r + V3d(dice_.normal(), dice_.normal(), dice_.normal()) * spread;
                    if (d.dot(n) < 0) d -= n * (2 * d.dot(n));
                    sum += incoming(p, d.normalized(), width);
                }
                return metal * sum / rays;
            });
        }
        if (kind == "glossy") {
            const double shine = dice_.uniform(0.03, 0.08), blurry = dice_.chance(0.4) ? 6 : 0;
            const bool patterned = c < 0.3;
            return fill_ball(to, centre, o, [&](V3d n, V3d r, V3d p, double width) {
                const double facing = std::clamp(-p.normalized().dot(n), 0.0, 1.0);
                const double fresnel = shine + (1 - shine) * std::pow(1 - facing, 5);
                return (patterned ? pattern(n) : paint) * matte(n) +
                       (blurry > 0 ? environment_->rough(turned(r), blurry)
                                   : incoming(p, r, width)) *
                           fresnel;
            });
        }
        if (kind == "painted")
            return fill_ball(to, centre, o,
                             [&](V3d n, V3d, V3d, double) { return pattern(n) * matte(n); });
        if (kind == "planet") {
            const double size = dice_.log_uniform(1, 8), rough = dice_.uniform(0.45, 0.85);
            return fill_ball(to, centre, o, [&](V3d n, V3d, V3d, double) {
                const double t =
                    std::clamp(2.5 * fractal_noise(n * size + shift, 6, rough) - 0.75, 0.0, 1.0);
                return (paint * t + other * (1 - t)) * matte(n);
            });
        }
        if (kind == "moon") {
            const V3d sun = dice_.direction();
            const double size = dice_.log_uniform(1.5, 6);
            const V3d light = ambient() * dice_.log_uniform(1, 20);
            return fill_ball(to, centre, o, [&](V3d n, V3d, V3d, double) {
                const double relief = fractal_noise(n * size + shift, 6, 0.7);
                return light * std::clamp(1.5 * n.dot(sun) + 0.3 + 2 * (relief - 0.5), 0.0, 1.0) *
                       (0.3 + relief) * 0.3;
            });
        }
        const V3d light = ambient();
        if (kind == "disc") {
            Texture print = Texture::random(dice_);
            const double border = dice_.uniform(0.8, 1.1);
            return fill_disk(to, tilted(o), [&](V2d p) {
                return (p.length() > border ? other : print.at(p.x, p.y, 3)) * light;
            });
        }
        if (kind == "picture") {  // a round window, a flat mirror, a print of a photo
            const double size = dice_.uniform(0.1, 0.7);
            return fill_disk(to, tilted(o), [&](V2d p) {
                return environment_->sharp(
                    (axis + aside * (size * p.x) + third * (size * p.y)).normalized());
            });
        }
        if (kind == "wheel") {
            const int spokes = dice_.whole(3, 24);
            const double tyre = dice_.uniform(0.6, 0.95), hub = dice_.uniform(0.05, 0.3);
            const double width = dice_.uniform(0.1, 0.6);
            const bool open = dice_.chance(0.5);
            return fill_disk(to, tilted(o), [&](V2d p) {
                const double rho = p.length();
                const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) * spokes + 9;
                if (rho > tyre) return other * 0.2 * light * (0.6 + 0.4 * p.y);
                if (rho < hub || turn - std::floor(turn) < width || rho > tyre - 0.05)
                    return paint * light * (0.6 + 0.6 * hash(int(turn), 2, 3));
                if (!open) return other * light * 0.1;
                const int x = std::clamp(int(o.cx + p.x * o.a), 0, size_.width - 1);
                const int y = std::clamp(int(o.cy + p.y * o.a), 0, size_.height - 1);
                return V3d(canvas_.color[canvas_.at(x, y)]);
            });
        }
        if (kind == "plate") {
            const double well = dice_.uniform(0.5, 0.8), shine = dice_.uniform(0, 0.5);
            return fill_disk(to, tilted(o), [&](V2d p) {
                const double rho = p.length();
                const double lift = rho > well ? 0.5 : rho > well - 0.06 ? -0.8 : 0;
                const V3d n = V3d(lift * p.x, -lift * p.y, 1).normalized();
                const bool band = c < 0.5 && std::abs(rho - 0.9) < 0.04;
                return (band ? other : paint) * matte(n) +
                       environment_->rough(turned(n * (2 * n.z) - V3d(0, 0, 1)), 6) * shine * 0.3;
            });
        }
        if (kind == "lens") {
            const int rings = dice_.whole(2, 6);
            return fill_ball(to, centre, o, [&](V3d n, V3d r, V3d p, double width) {
                const double rho = std::sqrt(std::max(0.0, 1 - std::pow(p.normalized().dot(n), 2)));
                if (rho > 0.55 + 0.35 * a) {
                    const double ring = rho * rings * 4;
                    return paint * matte(n) * (ring - std::floor(ring) < 0.3 ? 0.3 : 0.08);
                }
                const V3d weak = V3d(0.4 + b, 0.5, 0.4 + c) * 0.05;
                const V3d again = centre.normalized() * (2 * r.dot(centre.normalized()));
                return incoming(p, r, width) * weak +
                       environment_->sharp(turned(again - r), width) * weak * 0.6;
            });
        }
        if (kind == "ring") {
            const double inner = dice_.uniform(0.4, 0.8), rough = dice_.chance(0.5) ? 8 : 0;
            const Outline outer = tilted(o);
            return fill_disk(to, outer, [&](V2d p) {
                const double rho = p.length();
                if (rho < inner) {
                    const int x = std::clamp(int(outer.cx + p.x * o.a), 0, size_.width - 1);
                    const int y = std::clamp(int(outer.cy + p.y * o.a), 0, size_.height - 1);
                    return V3d(canvas_.color[canvas_.at(x, y)]);
                }
                const double t = std::clamp((2 * rho - 1 - inner) / (1 - inner), -1.0, 1.0);
                const V3d n(t * p.x / rho, -t * p.y / rho, std::sqrt(1 - t * t));
                return rough > 0
                           ? environment_->rough(turned(n * (2 * n.z) - V3d(0, 0, 1)), rough) *
                                 paint
                           : paint * matte(n);
            });
        }
    }

    /// Another thing of any kind, elsewhere. Rarely a second mirror ball.
    void clutter(RandomPicture& picture, double largest) {
        static const char* kinds[] = {"matte",   "rough", "glossy", "painted", "planet", "disc",
                                      "wheel",   "plate", "ring",   "moon",    "box",    "painted",
                                      "painted", "pole",  "cone",   "matte"};
        std::string kind = kinds[dice_.whole(0, 15)];
        const double r = radius_ * dice_.log_uniform(0.2, 1.5) * std::min(1.0, largest + 0.3);
        const double x = dice_.uniform(0, size_.width), y = dice_.uniform(0, size_.height);
        if (kind == "box" || kind == "pole" || kind == "cone") {
            const Texture texture = [&] {
                Texture t = Texture::random(dice_);
                t.pitch *= 2;
                return t;
            }();
            const double turn = dice_.chance(0.5) ? 0 : dice_.uniform(0, 3.14), c = std::cos(turn),
                         s = std::sin(turn),
                         tall = kind == "pole" ? 9 : dice_.log_uniform(0.4, 2.5);
            const V3d light = ambient();
            // Not over the middle of the main thing.
            if (std::hypot(x - outline().cx, y - outline().cy) < 1.3 * r + 0.7 * radius_) return;
            quad(canvas_, x, y, r * (tall > 5 ? 0.15 : 1), r * (tall > 5 ? 9 : tall), c, s,
                 [&](double u, double v) {
                     return kind == "cone" && std::abs(u) > 0.5 + 0.5 * v
                                ? std::optional<V3d>()
                                : texture.at(u, v * tall, 3) * light * (1 - 0.4 * u);
                 });
            return;
        }
        const V3d centre = place(x, y, f() / r);
        if (centre.length() < 2) return;
        const Outline o = outline_at(centre), main = outline();
        if (o.b < 0.75 * o.a || std::hypot(o.cx - main.cx, o.cy - main.cy) < o.a + 0.8 * main.a)
            return;
        if (dice_.chance(0.05)) kind = "mirror";
        if (kind == "mirror") {
            for (const Outline& seen : picture.balls)
                if (std::hypot(o.cx - seen.cx, o.cy - seen.cy) < o.a + seen.a) return;
            picture.balls.push_back(o);
        }
        draw_thing(canvas_, kind, centre, o);
    }

    template <class Color>
    void quad(Canvas& to, double x, double y, double rx, double ry, double c, double s,
              const Color& color) {
        const double reach = std::hypot(rx, ry) + 1;
        for (int j = std::max(0, int(y - reach)); j < std::min<double>(size_.height, y + reach);
             ++j)
            for (int i = std::max(0, int(x - reach)); i < std::min<double>(size_.width, x + reach);
                 ++i) {
                V3d sum(0);
                int hits = 0;
                for (int k = 0; k < 4; ++k) {
                    const double dx = i + 0.25 + 0.5 * (k & 1) - x,
                                 dy = j + 0.25 + 0.5 * (k >> 1) - y;
                    const double u = (c * dx + s * dy) / rx, v = (c * dy - s * dx) / ry;
                    if (std::abs(u) > 1 || std::abs(v) > 1) continue;
                    if (const std::optional<V3d> light = color(u, v)) sum += *light, ++hits;
                }
                if (hits > 0) to.add(i, j, sum / hits, 0.25 * hits);
            }
    }

    void stand(Canvas& to) {
        const Outline o = outline();
        const V3d color = dice_.color(0.2) * 0.5, light = ambient();
        const double half = o.b * dice_.log_uniform(0.05, 0.55);
        const double low = dice_.uniform(0.85, 0.99) * o.b, height = dice_.uniform(0.2, 2) * o.b;
        const double noise = dice_.uniform(0, 0.4);
        quad(to, o.cx, o.cy + low + height, half, height, 1, 0, [&](double u, double v) {
            return std::optional<V3d>(color * light * (1 - 0.7 * u * u) *
                                      (1 + noise * (value_noise(V3d(9 * u, 9 * v, 1)) - 0.5)));
        });
    }

    /// A hand from one side, or a pole before the ball.
    void occluder() {
        const Outline o = outline();
        const double turn = dice_.uniform(0, 6.2832);
        const V3d light = ambient();
        if (dice_.chance(0.5)) {
            const double off = dice_.uniform(0.3, 1) * o.b, half = o.b * dice_.uniform(0.08, 0.3);
            const Texture texture = Texture::random(dice_);
            quad(canvas_, o.cx + off * std::cos(turn), o.cy + off * std::sin(turn), half, 9 * o.b,
                 std::cos(turn), std::sin(turn), [&](double u, double v) {
                     return std::optional<V3d>(texture.at(0.2 * u, v, 3) * light * (1 - 0.4 * u));
                 });
            return;
        }
        const V3d skin = V3d(0.6, 0.4, 0.3) * dice_.log_uniform(0.3, 1.2);
        for (int finger = 0; finger < 5; ++finger) {
            const double at = turn + 0.22 * (finger - 2) + dice_.uniform(-0.04, 0.04);
            const double off = o.b * (finger == 0 ? 1.15 : dice_.uniform(0.95, 1.1));
            const Outline part{o.cx + off * std::cos(at), o.cy + off * std::sin(at),
                               o.b * dice_.uniform(0.2, 0.3), o.b * 0.09,
                               at * 180 / std::numbers::pi};
            fill(canvas_, part, [&](int x, int y) {
                return skin * light * (0.8 + 0.4 * value_noise(V3d(0.2 * x, 0.2 * y, 4)));
            });
        }
    }

    /// Through lens, sensor and file.
    Photo photographed() {
        if (dice_.chance(0.7)) canvas_.blur(dice_.uniform(0.2, 0.5));
        if (hard_ == unsharp) {
            const double soft = std::min(dice_.log_uniform(0.7, 5), 0.08 * radius_);
            canvas_.blur(soft);
            canvas_.blur(0.7 * soft);
        }
        double mean = 0, log_mean = 0;
        for (const V3f& c : canvas_.color) {
            mean += std::min(c.y, 50.f);
            log_mean += std::log(c.y + 1e-3f);
        }
        const double n = static_cast<double>(canvas_.color.size());
        const double seen = std::sqrt((mean / n + 1e-4) * std::exp(log_mean / n));
        const double grey = std::sqrt(seen * (ambient().y + 1e-3));
        const double stops = hard_ == badly_lit ? dice_.uniform(-3, 1.5) : dice_.uniform(-0.6, 0.6);
        const double exposure = 0.18 / grey * std::exp2(stops);
        const double vignette = dice_.chance(0.3) ? dice_.uniform(0, 0.5) : 0;
        const double shot = dice_.chance(0.4) ? dice_.log_uniform(0.002, 0.04) : 0.002;
        const double read = dice_.chance(0.3) ? dice_.log_uniform(0.0005, 0.01) : 0.0005;
        const int file = dice_.whole(0, 19);  // 0-3 float, 4 log, 5 mono, others sRGB
        const bool mono = file == 5;
        for (std::size_t i = 0; i < canvas_.color.size(); ++i) {
            const double x = double(i % std::size_t(size_.width)) / size_.width - 0.5;
            const double y = double(i / std::size_t(size_.width)) / size_.height - 0.5;
            V3d c = V3d(canvas_.color[i]) * exposure * (1 - vignette * 2 * (x * x + y * y));
            if (mono) c = V3d(0.3 * c.x + 0.5 * c.y + 0.2 * c.z);
            const double common = dice_.normal();
            for (int k = 0; k < 3; ++k)
                c[k] += (mono ? common : dice_.normal()) *
                        (read + shot * std::sqrt(std::clamp(c[k], 0.0, 1.0)));
            canvas_.color[i] = V3f(c);
        }
        return file <= 3 ? floats() : codes(file == 4, mono);
    }

    Photo floats() {
        std::vector<float> light;
        for (const V3f& c : canvas_.color)
            for (int k = 0; k < 3; ++k) light.push_back(c[k]);
        return float_photo(light, size_);
    }

    Photo codes(bool log, bool mono) {
        const bool jpeg = !log && dice_.chance(0.7);
        const double quality = dice_.uniform(65, 97);
        std::array<std::vector<float>, 3> planes;
        for (const V3f& c : canvas_.color) {
            V3d v;
            for (int k = 0; k < 3; ++k) {
                const double light = std::max(0.f, c[k]);
                v[k] = log ? 0.25 + 0.1 * std::log2(0.06 + 4 * light)
                       : light <= 0.0031308
                           ? 12.92 * light
                           : 1.055 * std::pow(std::min(light, 1.0), 1 / 2.4) - 0.055;
                v[k] = 255 * std::clamp(v[k], 0.0, 1.0);
            }
            const double luma = 0.299 * v.x + 0.587 * v.y + 0.114 * v.z;
            planes[0].push_back(float(luma));
            planes[1].push_back(float(0.564 * (v.z - luma)));
            planes[2].push_back(float(0.713 * (v.x - luma)));
        }
        if (jpeg)
            for (std::size_t k = 0; k < 3; ++k) compress(planes[k], quality, k > 0);
        const int channels = mono && dice_.chance(0.5) ? 1 : 3;
        Photo photo = empty_photo(size_, PixelType::u8, channels);
        for (std::size_t i = 0; i < canvas_.color.size(); ++i) {
            const double y = planes[0][i], b = planes[1][i], r = planes[2][i];
            const double rgb[] = {y + r / 0.713, y - 0.344 * b / 0.564 - 0.714 * r / 0.713,
                                  y + b / 0.564};
            for (int k = 0; k < channels; ++k)
                photo.pixels[i * std::size_t(channels) + std::size_t(k)] = static_cast<std::byte>(
                    std::lround(std::clamp(channels == 1 ? y : rgb[k], 0.0, 255.0)));
        }
        return photo;
    }

    /// What a JPEG of that quality leaves of one plane.
    void compress(std::vector<float>& plane, double quality, bool chroma) const {
        const double scale = (quality < 50 ? 50 / quality : 2 - quality / 50);
        std::array<std::array<float, 8>, 8> wave;
        for (int k = 0; k < 8; ++k)
            for (int i = 0; i < 8; ++i)
                wave[std::size_t(k)][std::size_t(i)] =
                    static_cast<float>((k == 0 ? std::sqrt(0.125) : 0.5) *
                                       std::cos((i + 0.5) * k * std::numbers::pi / 8));
        for (int by = 0; by + 8 <= size_.height; by += 8)
            for (int bx = 0; bx + 8 <= size_.width; bx += 8) {
                float in[8][8], half[8][8], out[8][8];
                for (int y = 0; y < 8; ++y)
                    for (int x = 0; x < 8; ++x) in[y][x] = plane[canvas_.at(bx + x, by + y)];
                const auto transform = [&](const float(&from)[8][8], float(&to)[8][8], bool back) {
                    for (std::size_t y = 0; y < 8; ++y)
                        for (std::size_t k = 0; k < 8; ++k) {
                            float sum = 0;
                            for (std::size_t i = 0; i < 8; ++i)
                                sum += from[y][i] * (back ? wave[i][k] : wave[k][i]);
                            to[k][y] = sum;  // and turned, for the other direction
                        }
                };
                transform(in, half, false);
                transform(half, out, false);
                for (int v = 0; v < 8; ++v)
                    for (int u = 0; u < 8; ++u) {
                        // About the usual tables: 16 at the mean, growing with frequency.
                        const double step = std::max(
                            1.0,
                            scale * (chroma ? 17 + 12 * std::min(u + v, 7) : 11 + 7 * (u + v)));
                        out[v][u] = static_cast<float>(std::round(out[v][u] / step) * step);
                    }
                transform(out, half, true);
                transform(half, in, true);
                for (int y = 0; y < 8; ++y)
                    for (int x = 0; x < 8; ++x) plane[canvas_.at(bx + x, by + y)] = in[y][x];
            }
    }

    double least_radius_;
    bool all_moving_;
    Dice dice_;
    Canvas canvas_;
    unsigned number_;
    Size size_;
    std::string kind_;
    enum Hard : int { badly_lit, unsharp, moving, hidden, cut, small } hard_ = small;  ///< or none
    Camera camera_;
    const Plate* plate_ = nullptr;
    const Environment* environment_ = nullptr;
    double scale_ = 1, left_ = 0, top_ = 0;
    bool flip_ = false;
    std::array<V3d, 3> rows_{V3d(1, 0, 0), V3d(0, 1, 0), V3d(0, 0, 1)};
    V3d centre_, up_, reflectance_, cloth_;
    double radius_ = 0, below_ = 1, reach_ = 0, dirt_ = 0, person_ = 0, grain_ = 0;
    std::optional<Texture> table_;
};

/// A picture like those that people take, from a number, its longer side between the two sizes in
/// pixels. Half hold a mirror ball; the others other round things, or none. With `moving`, all
/// moved while the shutter was open.
inline RandomPicture random_picture(unsigned number, double smallest = 180, double largest = 300,
                                    bool moving = false) {
    return Studio(number, smallest, largest, moving).made();
}

}  // namespace chromeball::painted
