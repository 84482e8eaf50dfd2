#include "resample/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace chromeball {
namespace {

using kernel::SourceForm;
using kernel::TargetForm;
using std::numbers::pi;

float single(double value) { return static_cast<float>(value); }

/// The axes of a source's own frame, in the source's world.
struct Axes {
    V3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

/// Chebyshev's nodes: interpolation there is nearly the best polynomial.
double node(int k, int count) { return std::cos(pi * (k + 0.5) / count); }

/// The polynomial through f at the nodes on [-1, 1], lowest power first.
template <class F>
std::vector<double> polynomial(const F& f, int terms) {
    std::vector<double> chebyshev(static_cast<std::size_t>(terms));
    for (int k = 0; k < terms; ++k) {
        const double value = f(node(k, terms));
        for (int i = 0; i < terms; ++i)
            chebyshev[static_cast<std::size_t>(i)] +=
                (i == 0 ? 1.0 : 2.0) / terms * value * std::cos(pi * i * (k + 0.5) / terms);
    }
    // T(i + 1) = 2 x T(i) - T(i - 1)
    std::vector<double> powers(chebyshev.size()), now(chebyshev.size()), before(chebyshev.size());
    now[0] = 1;
    for (std::size_t i = 0; i < chebyshev.size(); ++i) {
        for (std::size_t p = 0; p < powers.size(); ++p) powers[p] += chebyshev[i] * now[p];
        std::vector<double> next(chebyshev.size());
        for (std::size_t p = 0; p < next.size(); ++p)
            next[p] = (p > 0 ? (i == 0 ? 1 : 2) * now[p - 1] : 0) - before[p];
        before = now;
        now = next;
    }
    return powers;
}

double evaluated(const std::vector<double>& powers, double x) {
    double sum = 0;
    for (std::size_t i = powers.size(); i-- > 0;) sum = sum * x + powers[i];
    return sum;
}

/// g(v) of a near ball with so many terms that its error, at most 1e-7 of g, is a float's.
void set_view_ratio(SourceForm& form, const MirrorBall& ball, double lowest_v) {
    const double middle = 0.5 * (1 + lowest_v), half = 0.5 * (1 - lowest_v);
    const auto g = [&](double x) { return ball.view_ratio(middle + half * x); };
    std::vector<double> powers;
    for (int terms = 5; terms <= SourceForm::kMostTerms; ++terms) {
        powers = polynomial(g, terms);
        double worst = 0;
        for (int i = 0; i <= 200; ++i) {
            const double x = i / 100.0 - 1;
            worst = std::max(worst, std::abs(evaluated(powers, x) / g(x) - 1));
        }
        if (worst < 2e-8) break;
    }
    form.g_terms = static_cast<int>(powers.size());
    for (std::size_t i = 0; i < powers.size(); ++i)
        form.g[i] = single(powers[powers.size() - 1 - i]);
    form.g_middle = single(middle);
    form.g_scale = single(1 / half);
}

/// The linear part of `affine` after a linear map (row by row).
std::array<float, 4> composed(const Affine& affine, const std::array<double, 4>& m) {
    return {
        single(affine.xx * m[0] + affine.xy * m[2]), single(affine.xx * m[1] + affine.xy * m[3]),
        single(affine.yx * m[0] + affine.yy * m[2]), single(affine.yx * m[1] + affine.yy * m[3])};
}

void set_near(SourceForm& form, const MirrorBall& ball, const Affine& to_pixels, Axes& axes) {
    const V3d c = ball.axis();
    axes.z = -c;
    axes.x = (std::abs(c.x) < 0.7 ? V3d(1, 0, 0) : V3d(0, 1, 0)).cross(c).normalized();
    axes.y = c.cross(axes.x);
    form.hidden_v = single(std::sin(0.5 * ball.hidden_half_angle()));
    set_view_ratio(form, ball, std::sin(0.5 * ball.hidden_half_angle()));

    // The ray c + a e1 + b e2 meets the plane z = -1 off the axis' own place by M (a, b) / (1 +
    // k.(a, b)).
    const V3d &e1 = axes.x, &e2 = axes.y;
    form.k_a = single(e1.z / c.z);
    form.k_b = single(e2.z / c.z);
    const std::array<double, 4> plane{
        (c.x * e1.z - e1.x * c.z) / (c.z * c.z), (c.x * e2.z - e2.x * c.z) / (c.z * c.z),
        (e1.y * c.z - c.y * e1.z) / (c.z * c.z), (e2.y * c.z - c.y * e2.z) / (c.z * c.z)};
    const V2d at_axis(-c.x / c.z, c.y / c.z);
    const double f = ball.focal();
    const std::array<double, 4> magnify{f, 0, 0, f};
    const V2d base = to_pixels(ball.principal() + ball.distortion().distorted(at_axis) * f);
    form.base_x = single(base.x);
    form.base_y = single(base.y);
    const Distortion& lens = ball.distortion();
    if (lens.none()) {
        form.to_pixels =
            composed(to_pixels, {f * plane[0], f * plane[1], f * plane[2], f * plane[3]});
        return;
    }
    form.lens = true;
    form.lens_x = single(at_axis.x);
    form.lens_y = single(at_axis.y);
    form.k1 = single(lens.k1);
    form.k2 = single(lens.k2);
    form.k3 = single(lens.k3);
    form.to_pixels = composed(Affine{}, plane);
    form.lens_to_pixels = composed(to_pixels, magnify);
}

void set_ball(SourceForm& form, const Source& source, const MirrorBall& ball, Axes& axes) {
    form.shape = SourceForm::Shape::ball;
    // Between a direction's cosine to the axis and v: v^2 = (1 - cosine) / 2.
    form.curved_v = single(std::sqrt(0.5 * (1 - ball.curved_cosine())));
    if (ball.orthographic()) {
        form.to_pixels = composed(source.to_pixels, ball.from_disk());
        const V2d base = source.to_pixels(V2d(ball.outline().cx, ball.outline().cy));
        form.base_x = single(base.x);
        form.base_y = single(base.y);
    } else {
        set_near(form, ball, source.to_pixels, axes);
    }
    form.left = single(source.left);
    form.top = single(source.top);
    form.right = single(source.right);
    form.bottom = single(source.bottom);

    const Outline& outline = *source.ball;
    const double turn = outline.angle * pi / 180;
    form.centre_x = single(outline.cx);
    form.centre_y = single(outline.cy);
    form.to_disk = {single(std::cos(turn) / outline.a), single(std::sin(turn) / outline.a),
                    single(-std::sin(turn) / outline.b), single(std::cos(turn) / outline.b)};
    form.long_axis = single(outline.a);
    form.short_axis = single(outline.b);
    const RimStrip& rim = source.rim;
    if (rim.pixels().empty()) return;
    form.strip = {rim.pixels().row(0),      rim.pixels().width() - 1,
                  rim.pixels().height(),    single(rim.first_depth()),
                  single(rim.last_depth()), single(rim.rows_per_pixel())};
}

void set_map(SourceForm& form, const Source& source) {
    const double border = source.border;
    const bool cube = std::holds_alternative<Cube>(source.projection);
    const double width = cube ? source.face_size : source.to_pixels.xx;
    const double height = cube ? source.face_size : source.to_pixels.yy;
    form.x0 = form.y0 = single(border);
    form.x_scale = single(width);
    form.y_scale = single(height);
    form.left = form.top = 0.5F;
    form.right = single(width + 2 * border - 0.5);
    form.bottom = single(height + 2 * border - 0.5);
    if (cube) {
        form.shape = SourceForm::Shape::cube;
        const int padded = source.face_size + 2 * source.border;
        form.face_pixels = padded * padded;
    } else if (std::holds_alternative<LatLong>(source.projection)) {
        form.shape = SourceForm::Shape::latlong;
    } else {
        form.shape = SourceForm::Shape::angular;
        // No seams; its edge bends.
        form.left = form.top = std::numeric_limits<float>::lowest();
        form.right = form.bottom = std::numeric_limits<float>::max();
    }
}

/// Rows: the axes; columns: what directions of the target's frame are made of.
std::array<float, 9> matrix(const Axes& axes, const Rotation& rotation, const V3d (&columns)[3]) {
    std::array<float, 9> m{};
    const V3d* rows[3] = {&axes.x, &axes.y, &axes.z};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            m[3 * i + j] = single(rows[i]->dot(rotation * columns[j]));
    return m;
}

void add_tiles(Plan& plan, const TargetForm& target, int width, int height, int cell_x,
               int cell_y) {
    for (int y = 0; y < height; y += kernel::kTileHeight)
        for (int x = 0; x < width; x += kernel::kTileWidth) {
            kernel::Tile tile;
            tile.target = target;
            tile.x0 = x;
            tile.y0 = y;
            tile.x1 = std::min(width, x + kernel::kTileWidth);
            tile.y1 = std::min(height, y + kernel::kTileHeight);
            plan.tiles.push_back({tile, cell_x, cell_y});
        }
}

bool too_large(const Image& picture) {
    return picture.size().pixels() > static_cast<std::size_t>(std::numeric_limits<int>::max());
}

}  // namespace

std::optional<Plan> plan_of(const Source& source, const Layout& layout, int size,
                            const ResampleOptions& options) {
    if (too_large(source.pixels)) return std::nullopt;
    Plan plan;
    plan.job.adaptive = options.filter == Filter::adaptive;
    SourceForm& form = plan.job.source;
    form.pixels = source.pixels.row(0);
    form.stride = source.pixels.width();
    Axes axes;
    if (const auto* ball = std::get_if<MirrorBall>(&source.projection))
        set_ball(form, source, *ball, axes);
    else
        set_map(form, source);

    const Rotation rotation = options.rotation.inverse();
    const Size picture = layout.picture(size);
    TargetForm target;
    if (const auto* cube = std::get_if<Cube>(&layout.projection)) {
        target.shape = TargetForm::Shape::face;
        target.width = target.height = static_cast<float>(size);
        for (int i = 0; i < 6; ++i) {
            const Face& face = cube->layout().faces[static_cast<std::size_t>(i)];
            target.matrix =
                matrix(axes, rotation, {face.right, face.down, cube->layout().forward(i)});
            add_tiles(plan, target, size, size, face.column * size, face.row * size);
        }
        return plan;
    }
    target.width = static_cast<float>(picture.width);
    target.height = static_cast<float>(picture.height);
    target.matrix = matrix(axes, rotation, {V3d(1, 0, 0), V3d(0, 1, 0), V3d(0, 0, 1)});
    if (const auto* ball = std::get_if<MirrorBall>(&layout.projection)) {
        const Outline &outline = ball->outline(), whole = MirrorBall().outline();
        if (!ball->orthographic() || outline.cx != whole.cx || outline.cy != whole.cy ||
            outline.a != whole.a || outline.b != whole.b)
            return std::nullopt;
        target.shape = TargetForm::Shape::ball;
    } else if (std::holds_alternative<Angular>(layout.projection)) {
        target.shape = TargetForm::Shape::angular;
    } else {
        target.shape = TargetForm::Shape::latlong;
    }
    add_tiles(plan, target, picture.width, picture.height, 0, 0);
    return plan;
}

}  // namespace chromeball
