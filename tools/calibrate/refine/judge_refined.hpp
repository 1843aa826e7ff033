#pragma once

#include "tools/calibrate/refine/refine.hpp"
#include "tools/calibrate/refine/take.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// What a refinement is worth, as sentences for people.
struct RefinedVerdict {
    std::vector<std::string> told;      // figures
    std::vector<std::string> problems;  // why the result should not be used, with the cure
};

/// `old`: the rig before. `is_whole`: all cameras were free.
RefinedVerdict judge_refined(const Refined& refined,
                             std::span<const geometry::CalibratedCamera> old,
                             const Take& take,
                             bool is_whole);

}  // namespace atrium::calibrate
