#pragma once

#include "bench/site/segmentation_scenes.hpp"

#include <functional>
#include <string>

namespace atrium::bench {

/// Real people, cut out of recordings with masks (ring20, dancer), in front of real empty rooms
/// (horseman), at random sizes, places and brightness, with shadows on the floor. Edges are mixed
/// as by a lens, and in half of the pictures colour has half the resolution. The truth is where a
/// person covers at least half of a pixel. The same pictures every time.
///
/// Returns false if a picture could not be read.
bool visit_pasted_people(const std::string& recordings,
                         const std::function<void(const SegmentationScene&)>& visit);

}  // namespace atrium::bench
