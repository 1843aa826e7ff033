#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <string>
#include <vector>

namespace atrium::views {

/// One input of the tool. `view.intrinsics` has the picture size.
struct NamedView {
    std::string name;
    hull::SilhouetteView view;
};

}  // namespace atrium::views
