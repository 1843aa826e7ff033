#include "tools/calibrate/sweep/covered_fields.hpp"

#include <algorithm>
#include <limits>

namespace atrium::calibrate {

std::size_t CoveredFields::field_of(const Eigen::Vector2d& px) const {
    const auto index = [](double place, int size) {
        return std::clamp(static_cast<int>((place + 0.5) * kFields / size), 0, kFields - 1);
    };
    return static_cast<std::size_t>(index(px.y(), height_) * kFields + index(px.x(), width_));
}

void CoveredFields::cover(const Eigen::Vector2d& px) { covered_[field_of(px)] = true; }

bool CoveredFields::is_covered(const Eigen::Vector2d& px) const { return covered_[field_of(px)]; }

double CoveredFields::share() const {
    return static_cast<double>(std::ranges::count(covered_, true)) /
           static_cast<double>(covered_.size());
}

const char* CoveredFields::emptiest_part() const {
    static constexpr std::array kParts{"lower left",
                                       "lower right",
                                       "upper left",
                                       "upper right",
                                       "left",
                                       "right",
                                       "top",
                                       "bottom",
                                       "middle"};
    static constexpr std::array<std::array<int, 2>, 9> kAt{
        {{0, 2}, {2, 2}, {0, 0}, {2, 0}, {0, 1}, {2, 1}, {1, 0}, {1, 2}, {1, 1}}};
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < kParts.size(); ++part) {
        int num_covered = 0, num_fields = 0;
        for (int y = 0; y < kFields; ++y) {
            for (int x = 0; x < kFields; ++x) {
                if (x * 3 / kFields != kAt[part][0] || y * 3 / kFields != kAt[part][1]) continue;
                ++num_fields;
                num_covered += at(x, y) ? 1 : 0;
            }
        }
        const double share = static_cast<double>(num_covered) / num_fields;
        if (share >= least) continue;
        least = share;
        best = part;
    }
    return kParts[best];
}

std::vector<std::vector<Eigen::Vector2d>> CoveredFields::outlines_px() const {
    std::vector<std::vector<Eigen::Vector2d>> outlines;
    const auto corner = [&](int x, int y) {
        return Eigen::Vector2d(static_cast<double>(x) * width_ / kFields - 0.5,
                               static_cast<double>(y) * height_ / kFields - 0.5);
    };
    for (int y = 0; y < kFields; ++y)
        for (int x = 0; x < kFields; ++x)
            if (at(x, y))
                outlines.push_back(
                    {corner(x, y), corner(x, y + 1), corner(x + 1, y + 1), corner(x + 1, y)});
    return outlines;
}

}  // namespace atrium::calibrate
