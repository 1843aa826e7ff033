#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace atrium::test {

using PassedDescriptors = std::vector<std::unique_ptr<Descriptor>>;

/// Runs `make` in a child process, which may enter other namespaces. Returns the descriptors that
/// it created there, at most 8, or its error. The child has ended by then.
Expected<PassedDescriptors> descriptors_made_in_child(
    const std::function<Expected<PassedDescriptors>()>& make);

}  // namespace atrium::test
