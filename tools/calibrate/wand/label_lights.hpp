#pragma once

#include "tools/calibrate/adjust/wand.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace atrium::calibrate {

/// Tells which light each bright point of one picture is.
///
/// On a line, an image of a place t is s(t) = t q / (1 + t (q - 1)), where s and t are 0 and 1 at
/// the ends and q is the ratio of the ends' depths: the cross-ratio of four points in another form.
/// It does not tell the direction, because four points read backwards have the same cross-ratio.
/// The depths do: read backwards, unequal distances need a wand that is far nearer at one end.
/// Other wands are nearly an affine image of their lights, from two directions that they span.
class LightLabeller {
public:
    /// Empty if the lights of the wand cannot be told apart: two on a line, or a wand that looks
    /// the same read backwards or turned. Such a wand needs points with labels.
    static std::optional<LightLabeller> make(const Wand& wand);

    /// Returns for each light the index of its point. Empty if the points of the wand are not all
    /// among `points`, or if there are two such sets. At most 24 points are tried.
    std::optional<std::vector<std::size_t>> label(std::span<const Eigen::Vector2d> points) const;

private:
    struct Candidate {
        std::vector<std::size_t> points;  // per light
        double error_px = 0.0;
        double turn = 0.0;  // of a line: |log of the ratio of the depths|
    };
    explicit LightLabeller(const Wand& wand) : wand_(wand) {}
    void find_lines(std::span<const Eigen::Vector2d> points, std::vector<Candidate>& found) const;
    void find_bodies(std::span<const Eigen::Vector2d> points, std::vector<Candidate>& found) const;
    bool tells_itself() const;

    Wand wand_;
    std::vector<std::size_t> order_;  // lights in the order of their search
    std::vector<double> places_;      // per light; of a line: 0 and 1 at its ends
};

}  // namespace atrium::calibrate
