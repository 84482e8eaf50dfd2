#include "render/shader.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "render/sampling.h"

namespace chromeball {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Paths end after that many surfaces, or when less than that of their light is left.
constexpr int kDeepest = 16;
constexpr float kLeast = 1e-3F;
/// Below that the lobe is narrower than what floats tell of it: a polished surface.
constexpr float kPolished = 0.02F;
/// Directions that the samples of a pixel try together on rough and matte surfaces.
constexpr int kTries = 64;

/// Two unit vectors across a third. Duff et al.: Building an Orthonormal Basis, Revisited, 2017.
struct Basis {
    V3f x, y, z;
    explicit Basis(const V3f& n) : z(n) {
        const float sign = std::copysign(1.0F, n.z);
        const float a = -1 / (sign + n.z), b = n.x * n.y * a;
        x = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
        y = {b, sign + n.y * n.y * a, -n.y};
    }
    V3f to_world(const V3f& v) const { return x * v.x + y * v.y + z * v.z; }
    V3f from_world(const V3f& v) const { return {v.dot(x), v.dot(y), v.dot(z)}; }
};

/// Where the ray meets the ball, of the two places the one nearest to `about`.
double distance_to(const Ball& ball, const V3d& origin, const V3d& direction, double about) {
    const V3d to_center = ball.center - origin;
    const double middle = to_center.dot(direction) / direction.length2();
    const double off = (to_center - direction * middle).length2();
    const double half =
        std::sqrt(std::max(0.0, ball.radius * ball.radius - off) / direction.length2());
    return std::abs(middle - half - about) < std::abs(middle + half - about) ? middle - half
                                                                             : middle + half;
}

float brightest(const V3f& c) { return std::max({c.x, c.y, c.z}); }

}  // namespace

/// A place of a surface and how it changes from sample to sample.
struct Shader::Surface {
    V3f position{0, 0, 0}, position_x{0, 0, 0}, position_y{0, 0, 0};
    V3f normal{0, 0, 1}, normal_x{0, 0, 0}, normal_y{0, 0, 0};  // towards where the ray came from
    V3f facet{0, 0, 1};  // the triangle's own normal, on the same side
    bool from_inside = false;
    const Object* object = nullptr;
    Hit hit;

    /// A beam that leaves from here; its direction is to be told.
    Beam leaving() const {
        Beam beam;
        beam.origin = position;
        beam.origin_x = position_x;
        beam.origin_y = position_y;
        return beam;
    }
    /// What a beam's change of d.n is, where its direction and the normal change by those.
    float cosine_by(const Beam& beam, const V3f& direction_by, const V3f& normal_by) const {
        return direction_by.dot(normal) + beam.direction.dot(normal_by);
    }
    /// A beam as a mirror with this normal sends it on, dn being direction.normal.
    Beam mirrored(const Beam& beam, float dn) const {
        const auto turned = [&](const V3f& direction_by, const V3f& normal_by) {
            const float by = cosine_by(beam, direction_by, normal_by);
            return direction_by - (normal_by * dn + normal * by) * 2;
        };
        Beam next = leaving();
        next.direction = beam.direction - normal * (2 * dn);
        next.direction_x = turned(beam.direction_x, normal_x);
        next.direction_y = turned(beam.direction_y, normal_y);
        return next;
    }
};

struct Shader::Path {
    SampleNumber sample;
    int depth = 0;        // surfaces met
    float weight = 1;     // what of the light here the eye sees
    bool inside = false;  // of glass
    Path after(float part) const {
        Path next = *this;
        ++next.depth;
        next.weight *= part;
        return next;
    }
    bool ends() const { return depth >= kDeepest || weight < kLeast; }
    std::uint32_t seed() const {
        return hashed(sample.seed + 0x9e3779b9U * static_cast<std::uint32_t>(depth));
    }
    /// Directions to try here: the pixel's samples share them; further on one each.
    int tries() const { return depth > 0 ? 1 : std::max(1, kTries / sample.count); }
};

Shader::Shader(const Scene& scene, const Tracer& tracer, const Environment& environment,
               Shading shading, const Environment* reflected)
    : scene_(scene),
      tracer_(tracer),
      environment_(environment),
      reflected_(reflected && shading != Shading::raytrace ? *reflected : environment),
      shading_(shading),
      skip_(1e-4F * static_cast<float>(bounds_of(scene).radius)) {}

Shader::Surface Shader::surface_at(const Beam& beam, const Hit& hit) const {
    Surface s;
    s.hit = hit;
    s.object = &scene_.objects[hit.object];
    const Object& object = *s.object;
    float t = hit.distance;
    V3f e1(0), e2(0);
    const std::array<std::uint32_t, 3>* corners = nullptr;
    if (object.ball) {
        const V3d origin(beam.origin), direction(beam.direction);
        const double exact =
            distance_to(*object.ball, origin, direction, static_cast<double>(hit.distance));
        const V3d at = origin + direction * exact;
        t = static_cast<float>(exact);
        s.position = V3f(at);
        s.facet = V3f((at - object.ball->center) / object.ball->radius);
        s.normal = s.facet;
    } else {
        corners = &object.mesh.triangles[hit.triangle];
        const V3f& a = object.mesh.positions[(*corners)[0]];
        e1 = object.mesh.positions[(*corners)[1]] - a;
        e2 = object.mesh.positions[(*corners)[2]] - a;
        s.position = a + e1 * hit.u + e2 * hit.v;
        s.facet = e1.cross(e2).normalized();
    }
    // The neighbouring samples' rays, on the plane that touches here.
    const float slope = beam.direction.dot(s.facet);
    const auto moved = [&](const V3f& origin_by, const V3f& direction_by) {
        const V3f step = origin_by + direction_by * t;
        return slope != 0 ? step - beam.direction * (step.dot(s.facet) / slope) : step;
    };
    s.position_x = moved(beam.origin_x, beam.direction_x);
    s.position_y = moved(beam.origin_y, beam.direction_y);
    if (object.ball) {
        const auto scale = static_cast<float>(1 / object.ball->radius);
        s.normal_x = s.position_x * scale;
        s.normal_y = s.position_y * scale;
    } else {
        const V3f& n0 = object.mesh.normals[(*corners)[0]];
        const V3f d1 = object.mesh.normals[(*corners)[1]] - n0;
        const V3f d2 = object.mesh.normals[(*corners)[2]] - n0;
        const V3f n = n0 + d1 * hit.u + d2 * hit.v;
        const float length = n.length();
        s.normal = length > 0 ? n / length : s.facet;
        const float g11 = e1.length2(), g12 = e1.dot(e2), g22 = e2.length2();
        const float det = g11 * g22 - g12 * g12;
        const auto turned = [&](const V3f& step) {
            if (!(det > 0) || !(length > 0)) return V3f(0);
            const float p = step.dot(e1), q = step.dot(e2);
            const V3f by = d1 * ((g22 * p - g12 * q) / det) + d2 * ((g11 * q - g12 * p) / det);
            return (by - s.normal * s.normal.dot(by)) / length;
        };
        s.normal_x = turned(s.position_x);
        s.normal_y = turned(s.position_y);
        if (s.normal.dot(s.facet) < 0) s.facet = -s.facet;  // what the normals say is outside
    }
    s.from_inside = beam.direction.dot(s.facet) > 0;
    if (s.from_inside) {
        s.facet = -s.facet;
        s.normal = -s.normal;
        s.normal_x = -s.normal_x;
        s.normal_y = -s.normal_y;
    }
    return s;
}

V3f Shader::seen(const Beam& beam, const Hit& hit, const SampleNumber& sample) const {
    if (shading_ == Shading::vertex && hit.object < vertex_colors_.size() &&
        !vertex_colors_[hit.object].empty()) {
        const auto& colors = vertex_colors_[hit.object];
        const auto& t = scene_.objects[hit.object].mesh.triangles[hit.triangle];
        return colors[t[0]] * (1 - hit.u - hit.v) + colors[t[1]] * hit.u + colors[t[2]] * hit.v;
    }
    return shaded(beam, surface_at(beam, hit), {.sample = sample});
}

V3f Shader::shaded(const Beam& beam, const Surface& surface, const Path& path) const {
    const Material& material = surface.object->material;
    switch (material.kind) {
        case Material::Kind::flat:
            return material.color;
        case Material::Kind::diffuse:
            return matte(beam, surface, path);
        case Material::Kind::glass:
            return glass(beam, surface, path);
        case Material::Kind::mirror:
        case Material::Kind::conductor:
            return material.roughness < kPolished ? polished(beam, surface, path)
                                                  : rough(beam, surface, path);
    }
    return V3f(0);
}

/// What comes along a beam that leaves a surface.
V3f Shader::along(const Beam& beam, const Surface& from, const Path& path) const {
    const V3f& d = beam.direction;
    if ((shading_ != Shading::raytrace && !path.inside) || path.ends())
        return reflected_.radiance(d, beam.direction_x, beam.direction_y);
    Beam next = beam;
    next.origin += from.facet * (d.dot(from.facet) > 0 ? skip_ : -skip_);
    const Hit hit = tracer_.intersect(next.origin, d, 0);
    if (!hit) return reflected_.radiance(d, beam.direction_x, beam.direction_y);
    return shaded(next, surface_at(next, hit), path);
}

V3f Shader::polished(const Beam& beam, const Surface& s, const Path& path) const {
    const float dn = beam.direction.dot(s.normal);
    Beam next = s.mirrored(beam, dn);
    const V3f part = reflectance(s.object->material, -dn);
    if (shading_ == Shading::raytrace) {
        // A smooth normal can send light into its own triangle; it leaves along it then.
        const float up = next.direction.dot(s.facet);
        if (up < 1e-3F) next.direction = (next.direction + s.facet * (1e-3F - up)).normalized();
    }
    return part * along(next, s, path.after(brightest(part)));
}

V3f Shader::spread(const V3f& direction, float solid_angle, const Surface& from,
                   const Path& path) const {
    // A ray stands for a patch of the sky, whose shape nobody knows: round.
    if (shading_ != Shading::raytrace || path.ends())
        return reflected_.radiance(direction, solid_angle);
    const V3f origin = from.position + from.facet * skip_;
    const Hit hit = tracer_.intersect(origin, direction, 0);
    if (!hit) return reflected_.radiance(direction, solid_angle);
    const Basis basis(direction);
    const float side = std::sqrt(solid_angle);
    const Beam beam{origin, direction, V3f(0), V3f(0), basis.x * side, basis.y * side};
    return shaded(beam, surface_at(beam, hit), path);
}

V3f Shader::rough(const Beam& beam, const Surface& s, const Path& path) const {
    const Material& material = s.object->material;
    const float alpha = material.roughness * material.roughness;
    const Basis basis(s.normal);
    V3f v = basis.from_world(-beam.direction);
    v.z = std::max(v.z, 1e-3F);
    v.normalize();
    const int tries = path.tries();
    const auto all = static_cast<float>(tries * path.sample.count);
    const float lambda_v = ggx_lambda(v, alpha);
    V3f sum(0);
    for (int i = 0; i < tries; ++i) {
        const auto index =
            path.sample.index * static_cast<std::uint32_t>(tries) + static_cast<std::uint32_t>(i);
        const V3f h = visible_facet(v, alpha, spread_point(index, path.seed()));
        const float vh = v.dot(h);
        const V3f l = h * (2 * vh) - v;
        if (!(l.z > 0)) continue;
        const float masked = (1 + lambda_v) / (1 + lambda_v + ggx_lambda(l, alpha));
        // The density of l is that of h over 4 v.h.
        const float density = ggx_density(h, alpha) / (4 * v.z * (1 + lambda_v));
        const float solid_angle = std::min(1 / std::max(all * density, 1e-6F), kPi);
        const V3f part = reflectance(material, vh) * masked;
        sum += part * spread(basis.to_world(l), solid_angle, s, path.after(brightest(part)));
    }
    return sum / static_cast<float>(tries);
}

V3f Shader::matte(const Beam&, const Surface& s, const Path& path) const {
    const V3f& albedo = s.object->material.color;
    constexpr int kDeepestMatte = 4;
    if (shading_ != Shading::raytrace || path.depth >= kDeepestMatte || path.ends())
        return albedo * environment_.matte(s.normal);
    const Basis basis(s.normal);
    const int tries = path.tries();
    const auto all = static_cast<float>(tries * path.sample.count);
    V3f sum(0);
    for (int i = 0; i < tries; ++i) {
        const auto index =
            path.sample.index * static_cast<std::uint32_t>(tries) + static_cast<std::uint32_t>(i);
        const V3f l = cosine_direction(spread_point(index, path.seed()));
        const float solid_angle = std::min(kPi / (all * std::max(l.z, 0.01F)), kPi);
        sum += spread(basis.to_world(l), solid_angle, s, path.after(brightest(albedo)));
    }
    return albedo * sum / static_cast<float>(tries);
}

V3f Shader::glass(const Beam& beam, const Surface& s, const Path& path) const {
    const Material& material = s.object->material;
    const float eta = s.from_inside ? material.ior : 1 / material.ior;  // before over behind
    const V3f& d = beam.direction;
    const float dn = std::min(d.dot(s.normal), -1e-4F);
    const float reflected = fresnel_dielectric(-dn, 1 / eta);
    V3f sum(0);
    if (reflected > 0) {
        Path next = path.after(reflected);
        next.inside = s.from_inside;
        Beam mirrored = s.mirrored(beam, dn);
        mirrored.direction.normalize();  // dn is not below some least
        sum += along(mirrored, s, next) * reflected;
    }
    if (reflected < 1) {
        Path next = path.after(1 - reflected);
        next.inside = !s.from_inside;
        // Snell's law in vectors: T = eta D - mu N, after Igehy.
        const float tn = -std::sqrt(std::max(0.0F, 1 - eta * eta * (1 - dn * dn)));
        const float mu = eta * dn - tn;
        Beam bent = s.leaving();
        bent.direction = (d * eta - s.normal * mu).normalized();
        const float mu_by = eta - eta * eta * dn / std::min(tn, -1e-3F);
        const auto turned = [&](const V3f& direction_by, const V3f& normal_by) {
            const float by = s.cosine_by(beam, direction_by, normal_by);
            return direction_by * eta - (normal_by * mu + s.normal * (mu_by * by));
        };
        bent.direction_x = turned(beam.direction_x, s.normal_x);
        bent.direction_y = turned(beam.direction_y, s.normal_y);
        sum += material.color * along(bent, s, next) * (1 - reflected);
    }
    return sum;
}

void Shader::shade_vertices(const View& view) {
    vertex_colors_.resize(scene_.objects.size());
    for (std::uint32_t o = 0; o < scene_.objects.size(); ++o) {
        const Object& object = scene_.objects[o];
        if (object.ball) continue;
        const Mesh& mesh = object.mesh;
        auto& colors = vertex_colors_[o];
        colors.resize(mesh.positions.size());
        for_each_band(static_cast<int>(colors.size()), 256, [&](int first, int last) {
            for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last);
                 ++i) {
                Beam beam;
                const V3d to_vertex = V3d(mesh.positions[i]) - view.eye();
                beam.origin = V3f(view.eye());
                beam.direction = view.orthographic() ? V3f(view.to_world() * V3d(0, 0, -1))
                                                     : V3f(to_vertex.normalized());
                Surface s;
                s.object = &object;
                s.position = mesh.positions[i];
                s.from_inside = beam.direction.dot(mesh.normals[i]) > 0;
                s.normal = s.from_inside ? -mesh.normals[i] : mesh.normals[i];
                s.facet = s.normal;
                const auto number = static_cast<std::uint32_t>(i);
                colors[i] = shaded(beam, s, {.sample = {hashed(number), 0, 1}});
            }
        });
    }
}

}  // namespace chromeball
