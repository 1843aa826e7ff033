#pragma once

#include "core/base/expected.hpp"
#include "core/bus/raw_samples.hpp"
#include "core/geometry/rigid_transform.hpp"

#include <map>
#include <string>
#include <vector>

namespace atrium::recording {

using Names = std::map<std::string, std::string>;
using Places = std::map<std::string, geometry::RigidTransform>;

/// The sample of another site: with the name that `names` gives its site, and, for a
/// SitePlacement, at the place that `places` has for the new name.
Expected<std::vector<std::byte>> renamed(const bus::RawTopic& topic,
                                         const bus::RawSample& sample,
                                         const Names& names,
                                         const Places& places);

/// The key of the renamed sample.
std::string renamed_key(const bus::RawTopic& topic, const std::string& key, const Names& names);

}  // namespace atrium::recording
