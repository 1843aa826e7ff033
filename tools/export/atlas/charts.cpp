#include "tools/export/atlas/charts.hpp"

#include "tools/export/atlas/projections.hpp"
#include "tools/export/atlas/texels_inside.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::exporting {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

constexpr int kPasses = 20;          // of agreeing with neighbours
constexpr float kAgreement = 1.5f;   // gain of having all neighbours in the same projection
constexpr float kLeastShare = 0.3f;  // of the best score, which agreement may cost
constexpr double kMaxTexels = 16e6;
constexpr float kShrink = 0.1f;  // [texels] neighbours share the texels on their common edge
constexpr int kGutter = 3;  // [texels] around each chart: bilinear and first mipmap stay inside

// The best projection of each triangle, then neighbours agree, one after another.
std::vector<std::uint32_t> choose(const renderer::PersonModel& model,
                                  const Projections& projections,
                                  const Triangles& beyond) {
    const std::size_t num_triangles = model.triangles.size();
    std::vector<std::uint32_t> chosen(num_triangles, 0);
    std::vector<float> best(num_triangles, 0.0f);
    for (std::uint32_t t = 0; t < num_triangles; ++t) {
        float most = -std::numeric_limits<float>::infinity();
        for (std::uint32_t p = 0; p < projections.size(); ++p) {
            if (projections.scores[p][t] > most) {
                most = projections.scores[p][t];
                chosen[t] = p;
            }
        }
        best[t] = std::max(most, 1e-9f);
    }
    for (int pass = 0; pass < kPasses; ++pass) {
        bool has_changed = false;
        for (std::uint32_t t = 0; t < num_triangles; ++t) {
            std::array<float, 3> share{};
            for (std::size_t e = 0; e < 3; ++e) {
                share[e] = (model.vertices_site[model.triangles[t][(e + 1) % 3]] -
                            model.vertices_site[model.triangles[t][e]])
                               .norm();
            }
            const float around = std::max(share[0] + share[1] + share[2], 1e-9f);
            const auto value = [&](std::uint32_t projection) {
                const float own = projections.scores[projection][t] / best[t];
                if (own < 0.0f || (own < kLeastShare && best[t] > 1e-9f)) return -1.0f;
                float sum = own;
                for (std::size_t e = 0; e < 3; ++e) {
                    const std::uint32_t other = beyond[t][e];
                    if (other != kNoTriangle && chosen[other] == projection)
                        sum += kAgreement * share[e] / around;
                }
                return sum;
            };
            std::uint32_t winner = chosen[t];
            float most = value(winner);
            for (const std::uint32_t other : beyond[t]) {
                if (other == kNoTriangle || chosen[other] == winner) continue;
                if (const float offered = value(chosen[other]); offered > most) {
                    most = offered;
                    winner = chosen[other];
                }
            }
            has_changed |= winner != chosen[t];
            chosen[t] = winner;
        }
        if (!has_changed) break;
    }
    return chosen;
}

// Of the rectangles around all triangles.
double num_texels(const Triangles& triangles,
                  const Projections& projections,
                  const std::vector<std::uint32_t>& chosen) {
    double sum = 0.0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto& places = projections.places[chosen[t]];
        Eigen::AlignedBox2f box;
        for (const std::uint32_t v : triangles[t]) box.extend(places[v]);
        if (!box.isEmpty()) sum += static_cast<double>(box.sizes().prod());
    }
    return sum;
}

// Which chart covers each texel of a projection.
class Covered {
public:
    Covered(const std::vector<Eigen::Vector2f>& places,
            const Triangles& triangles,
            const std::vector<std::uint32_t>& members) {
        Eigen::Array2f low = Eigen::Array2f::Constant(std::numeric_limits<float>::infinity());
        Eigen::Array2f high = -low;
        for (const std::uint32_t t : members) {
            for (const std::uint32_t v : triangles[t]) {
                low = low.min(places[v].array());
                high = high.max(places[v].array());
            }
        }
        if (members.empty()) return;
        low_ = low.floor().matrix();
        width_ = static_cast<int>(std::ceil(high.x() - low_.x())) + 1;
        const int height = static_cast<int>(std::ceil(high.y() - low_.y())) + 1;
        chart_of_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height),
                         kNoTriangle);
    }

    // Takes the texels of a triangle for a chart; false if the chart has one of them already.
    bool take(const std::array<Eigen::Vector2f, 3>& corners, std::uint32_t chart) {
        texels_.clear();
        const std::array<Eigen::Vector2f, 3> inside{
            corners[0] - low_, corners[1] - low_, corners[2] - low_};
        bool is_free = true;
        for_texels_inside(inside, -kShrink, [&](int x, int y, const Eigen::Vector3f&) {
            const std::size_t texel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                static_cast<std::size_t>(x);
            is_free &= chart_of_[texel] != chart;
            texels_.push_back(texel);
        });
        if (!is_free) return false;
        for (const std::size_t texel : texels_) chart_of_[texel] = chart;
        return true;
    }

private:
    Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
    int width_ = 0;
    std::vector<std::uint32_t> chart_of_;
    std::vector<std::size_t> texels_;
};

class ChartMaker {
public:
    ChartMaker(const Triangles& triangles,
               const Triangles& beyond,
               const std::vector<std::uint8_t>& is_thin,
               Charts& out)
        : triangles_(triangles), beyond_(beyond), is_thin_(is_thin), out_(out) {
        out_.chart_of.assign(triangles.size(), kNoTriangle);
        out_.places.resize(triangles.size());
        refused_by_.assign(triangles.size(), kNoTriangle);
    }

    void divide(const std::vector<Eigen::Vector2f>& places,
                std::uint32_t projection,
                const std::vector<std::uint32_t>& chosen) {
        std::vector<std::uint32_t> seeds;
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            if (chosen[t] != projection) continue;
            seeds.push_back(t);
            for (std::size_t i = 0; i < 3; ++i) out_.places[t][i] = places[triangles_[t][i]];
        }
        Covered covered(places, triangles_, seeds);
        // refused triangles become seeds in turn
        for (std::size_t next = 0; next < seeds.size(); ++next) {
            if (out_.chart_of[seeds[next]] == kNoTriangle)
                grow(seeds[next], chosen, covered, seeds);
        }
    }

private:
    void grow(std::uint32_t seed,
              const std::vector<std::uint32_t>& chosen,
              Covered& covered,
              std::vector<std::uint32_t>& seeds) {
        const auto chart = static_cast<std::uint32_t>(out_.charts.size());
        Eigen::Array2f low = Eigen::Array2f::Constant(std::numeric_limits<float>::infinity());
        Eigen::Array2f high = -low;
        const auto add = [&](std::uint32_t t) {
            if (is_thin_[t] == 0 && !covered.take(out_.places[t], chart)) {
                refused_by_[t] = chart;
                seeds.push_back(t);
                return;
            }
            out_.chart_of[t] = chart;
            for (const Eigen::Vector2f& place : out_.places[t]) {
                low = low.min(place.array());
                high = high.max(place.array());
            }
            queue_.push_back(t);
        };
        queue_.clear();
        add(seed);
        for (std::size_t i = 0; i < queue_.size(); ++i) {
            for (const std::uint32_t other : beyond_[queue_[i]]) {
                if (other == kNoTriangle || out_.chart_of[other] != kNoTriangle ||
                    chosen[other] != chosen[seed] || refused_by_[other] == chart)
                    continue;
                add(other);
            }
        }
        Charts::Chart made;
        made.low = low.floor().cast<int>() - kGutter;
        made.size = (high.ceil().cast<int>() + kGutter).matrix() - made.low;
        out_.charts.push_back(made);
    }

    const Triangles& triangles_;
    const Triangles& beyond_;
    const std::vector<std::uint8_t>& is_thin_;
    Charts& out_;
    std::vector<std::uint32_t> queue_;
    std::vector<std::uint32_t> refused_by_;  // per triangle: chart that it would cover
};

}  // namespace

Triangles neighbours(const Triangles& triangles) {
    struct Edge {
        std::uint64_t vertices;  // the smaller one in the upper half
        std::uint32_t triangle;
        std::uint32_t edge;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (std::uint32_t e = 0; e < 3; ++e) {
            const auto [low, high] = std::minmax(triangles[t][e], triangles[t][(e + 1) % 3]);
            edges.push_back({std::uint64_t{low} << 32U | high, t, e});
        }
    }
    std::ranges::sort(edges, {}, [](const Edge& edge) {
        return std::pair(edge.vertices, std::uint64_t{edge.triangle} << 2U | edge.edge);
    });
    Triangles beyond(triangles.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        if (edges[i].vertices != edges[i + 1].vertices) continue;
        beyond[edges[i].triangle][edges[i].edge] = edges[i + 1].triangle;
        beyond[edges[i + 1].triangle][edges[i + 1].edge] = edges[i].triangle;
        ++i;
    }
    return beyond;
}

Charts find_charts(const renderer::PersonModel& model, float scale) {
    Charts out;
    const Triangles beyond = neighbours(model.triangles);
    const Projections projections = find_projections(model, scale);
    const std::vector<std::uint32_t> chosen = choose(model, projections, beyond);
    if (num_texels(model.triangles, projections, chosen) > kMaxTexels && scale > kLeastScale) {
        out.is_too_large = true;
        return out;
    }
    ChartMaker maker(model.triangles, beyond, projections.is_thin, out);
    for (std::uint32_t p = 0; p < projections.size(); ++p)
        maker.divide(projections.places[p], p, chosen);
    out.is_at_border.resize(model.triangles.size());
    for (std::size_t t = 0; t < model.triangles.size(); ++t) {
        out.is_at_border[t] = std::ranges::any_of(beyond[t], [&](std::uint32_t other) {
            return other == kNoTriangle || out.chart_of[other] != out.chart_of[t];
        });
    }
    return out;
}

}  // namespace atrium::exporting
