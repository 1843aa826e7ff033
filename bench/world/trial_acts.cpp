#include "bench/world/trial_acts.hpp"

namespace atrium::bench {

const std::map<std::string, MakeAct>& trial_acts() {
    static const std::map<std::string, MakeAct> acts{
        {"palm", [](std::uint64_t seed) { return test::carry_on_palm(seed).act; }},
        {"tray", [](std::uint64_t seed) { return test::carry_on_tray(seed).act; }},
        {"clasp", [](std::uint64_t seed) { return test::clasp_move_turn(seed).act; }},
        {"giver", [](std::uint64_t seed) { return test::hand_over(seed).giver; }},
        {"taker", [](std::uint64_t seed) { return test::hand_over(seed).taker; }},
        {"throw", [](std::uint64_t seed) { return test::throw_forwards(seed).act; }},
        {"strike2",
         [](std::uint64_t seed) {
             return test::strike({0.0, 0.0, 1.1}, {1.0, 0.3, 0.1}, 2.0, seed).act;
         }},
        {"strike8",
         [](std::uint64_t seed) {
             return test::strike({0.0, 0.0, 1.1}, {1.0, 0.3, 0.1}, 8.0, seed).act;
         }},
    };
    return acts;
}

}  // namespace atrium::bench
