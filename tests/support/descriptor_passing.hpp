#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace atrium::test {

using PassedDescriptors = std::vector<std::unique_ptr<Descriptor>>;

/// Runs `make` in a child process, which may leave for other namespaces, and hands over the
/// descriptors that it made there, at most 8, or its error. The child is gone afterwards.
Expected<PassedDescriptors> descriptors_made_in_child(
    const std::function<Expected<PassedDescriptors>()>& make);

}  // namespace atrium::test
