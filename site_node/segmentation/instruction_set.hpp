#pragma once

#include <cstdint>

namespace atrium::segmentation {

enum class InstructionSet : std::uint8_t { kBaseline, kAvx2 };

/// Returns the best instruction set of this processor.
InstructionSet best_instruction_set();

}  // namespace atrium::segmentation
