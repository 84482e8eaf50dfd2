#include "render/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "core/error.h"

namespace chromeball {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

bool finite(const V3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Perpendicular to a triangle, as long as twice its area.
V3d double_area(const Mesh& mesh, const Triangle& t) {
    const V3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    return (b - a).cross(c - a);
}

/// A triangle that no ray can hit: no number, or no area against its sides.
bool degenerate(const Mesh& mesh, const Triangle& t) {
    const V3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    const double longest = std::max({(b - a).length2(), (c - b).length2(), (a - c).length2()});
    constexpr double kThin = 1e-12;  // of float coordinates nothing thinner has a direction
    return !(double_area(mesh, t).length() > kThin * longest);
}

struct PositionHash {
    std::size_t operator()(const V3f& v) const {
        std::size_t h = 0;
        for (const float part : {v.x, v.y, v.z}) {
            const float value = part + 0.0F;  // -0 is 0
            std::uint32_t bits = 0;
            std::memcpy(&bits, &value, sizeof bits);
            h = (h ^ bits) * 0x9e3779b97f4a7c15ULL;
            h ^= h >> 29;
        }
        return h;
    }
};

double angle_at(const V3d& corner, const V3d& one, const V3d& other) {
    const V3d a = one - corner, b = other - corner;
    return std::atan2(a.cross(b).length(), a.dot(b));
}

/// Normals from the triangles around each place, weighted by their angles there; corners get
/// positions of their own where the surface has an edge.
class Smoothing {
public:
    explicit Smoothing(const Mesh& mesh) : mesh_(mesh) {
        std::unordered_map<V3f, std::uint32_t, PositionHash> places;
        place_.reserve(mesh.positions.size());
        for (const V3f& p : mesh.positions)
            place_.push_back(places.emplace(p, std::uint32_t(places.size())).first->second);
        corners_.resize(places.size());
        for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
            const Triangle& t = mesh.triangles[i];
            face_.push_back(double_area(mesh, t).normalized());
            for (std::size_t k = 0; k < 3; ++k) corners_[place_[t[k]]].push_back({i, angle(t, k)});
        }
    }

    V3f normal(std::uint32_t triangle, std::uint32_t position) const {
        constexpr double kEdge = 0.5;           // cos 60 degrees
        constexpr std::size_t kManyFaces = 64;  // around the tip of a fan all count: n^2 otherwise
        const auto& around = corners_[place_[position]];
        V3d sum(0, 0, 0);
        for (const Corner& corner : around)
            if (around.size() > kManyFaces || face_[corner.triangle].dot(face_[triangle]) >= kEdge)
                sum += face_[corner.triangle] * corner.angle;
        const V3d n = sum.length2() > 0 ? sum.normalized() : face_[triangle];
        return V3f(n);
    }

private:
    struct Corner {
        std::uint32_t triangle;
        double angle;
    };
    double angle(const Triangle& t, std::size_t k) const {
        return angle_at(V3d(mesh_.positions[t[k]]), V3d(mesh_.positions[t[(k + 1) % 3]]),
                        V3d(mesh_.positions[t[(k + 2) % 3]]));
    }

    const Mesh& mesh_;
    std::vector<std::uint32_t> place_;  // of a position
    std::vector<std::vector<Corner>> corners_;
    std::vector<V3d> face_;
};

struct Vertex {
    V3f position, normal;
    bool operator==(const Vertex&) const = default;
};
struct VertexHash {
    std::size_t operator()(const Vertex& v) const {
        return PositionHash()(v.position) * 31 + PositionHash()(v.normal);
    }
};

/// Gives the corners of chosen positions smooth normals; the others keep theirs.
Mesh smoothed(const Mesh& mesh, const std::vector<bool>& wanting) {
    const Smoothing smoothing(mesh);
    Mesh out;
    std::unordered_map<Vertex, std::uint32_t, VertexHash> vertices;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        Triangle t{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t at = mesh.triangles[i][k];
            const Vertex v{mesh.positions[at],
                           wanting[at] ? smoothing.normal(i, at) : mesh.normals[at]};
            const auto [found, added] = vertices.emplace(v, std::uint32_t(out.positions.size()));
            if (added) {
                out.positions.push_back(v.position);
                out.normals.push_back(v.normal);
            }
            t[k] = found->second;
        }
        out.triangles.push_back(t);
    }
    return out;
}

/// Whether every edge is shared by two triangles, places that are equal being one.
bool closed(const Mesh& mesh) {
    std::unordered_map<V3f, std::uint32_t, PositionHash> places;
    std::unordered_map<std::uint64_t, int> edges;
    for (const Triangle& t : mesh.triangles) {
        std::uint64_t at[3];
        for (std::size_t k = 0; k < 3; ++k)
            at[k] =
                places.emplace(mesh.positions[t[k]], std::uint32_t(places.size())).first->second;
        for (int k = 0; k < 3; ++k) {
            const std::uint64_t from = at[k], to = at[(k + 1) % 3];
            edges[std::min(from, to) << 32 | std::max(from, to)] += from < to ? 1 : -1;
        }
    }
    return std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; });
}

void turn(Mesh& mesh) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    for (V3f& n : mesh.normals) n = -n;
}

}  // namespace

double six_volumes(const Mesh& mesh) {
    // From a place nearby: far from the origin the terms would cancel.
    const V3d base = mesh.positions.empty() ? V3d(0, 0, 0) : V3d(mesh.positions.front());
    double sum = 0;
    for (const Triangle& t : mesh.triangles)
        sum += (V3d(mesh.positions[t[0]]) - base)
                   .dot((V3d(mesh.positions[t[1]]) - base).cross(V3d(mesh.positions[t[2]]) - base));
    return sum;
}

Box box_of(const Mesh& mesh) {
    Box box;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const V3d p(mesh.positions[i]);
        for (int k = 0; k < 3; ++k) {
            box.low[k] = i == 0 ? p[k] : std::min(box.low[k], p[k]);
            box.high[k] = i == 0 ? p[k] : std::max(box.high[k], p[k]);
        }
    }
    return box;
}

void fit_into_unit_sphere(Mesh& mesh) {
    const V3d middle = box_of(mesh).middle();
    double furthest = 0;
    for (const V3f& p : mesh.positions) furthest = std::max(furthest, (V3d(p) - middle).length());
    if (!(furthest > 0)) return;
    for (V3f& p : mesh.positions) p = V3f((V3d(p) - middle) / furthest);
}

Mesh repaired(Mesh mesh, const std::string& name, std::vector<std::string>& notes) {
    if (mesh.triangles.empty())
        throw Error(Error::Kind::failed,
                    fmt::format("{}: has no faces{}; a surface is needed", name,
                                mesh.positions.empty() ? "" : ", only points or lines"));
    const std::size_t count = mesh.triangles.size();
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        return std::any_of(t.begin(), t.end(), [&](std::uint32_t i) {
            return i >= mesh.positions.size() || !finite(mesh.positions[i]);
        });
    });
    const std::size_t broken = count - mesh.triangles.size();
    std::erase_if(mesh.triangles, [&](const Triangle& t) { return degenerate(mesh, t); });
    const std::size_t thin = count - broken - mesh.triangles.size();
    if (mesh.triangles.empty())
        throw Error(
            Error::Kind::failed,
            fmt::format("{}: none of its {} triangles can be rendered: {} have positions that are "
                        "NaN or infinite, {} have no area; export it again",
                        name, count, broken, thin));
    if (broken > 0)
        notes.push_back(
            fmt::format("{}: {} of {} triangles have positions that are NaN or "
                        "infinite; they are left out",
                        name, broken, count));
    if (thin > 0)
        notes.push_back(fmt::format("{}: {} of {} triangles have no area; they are left out", name,
                                    thin, count));

    mesh.normals.resize(mesh.positions.size(), V3f(0, 0, 0));
    std::vector<bool> wanting(mesh.positions.size());
    std::size_t given = 0, bad = 0;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        V3f& n = mesh.normals[i];
        const float length = finite(n) ? n.length() : 0;
        wanting[i] = !(length > 1e-6F) || !std::isfinite(length);
        if (!wanting[i]) n /= length;
        given += !wanting[i];
        bad += wanting[i];
    }
    if (bad > 0 && given > 0)
        notes.push_back(fmt::format(
            "{}: {} normals have no direction; smooth ones take their place", name, bad));
    mesh = smoothed(mesh, wanting);
    if (six_volumes(mesh) < 0 && closed(mesh)) {
        turn(mesh);
        notes.push_back(fmt::format("{}: is inside out; its faces are turned", name));
    }
    return mesh;
}

}  // namespace chromeball
