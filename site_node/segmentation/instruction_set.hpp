#pragma once

#include <cstdint>

namespace atrium::segmentation {

enum class InstructionSet : std::uint8_t { kBaseline, kAvx2 };

/// The best one that this processor has.
InstructionSet best_instruction_set();

}  // namespace atrium::segmentation
