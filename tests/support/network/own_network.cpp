#include "tests/support/network/own_network.hpp"

#include "core/app/private_network.hpp"

namespace atrium::test_support {
namespace {

std::string& reason() {
    static std::string text = "enter_own_network was not called";
    return text;
}

}  // namespace

void enter_own_network(int num_addresses) {
    auto entered = app::enter_private_network();
    if (entered) entered = app::bring_up_loopback(num_addresses);
    reason() = entered ? "" : entered.error().message;
}

const std::string& reason_without_own_network() { return reason(); }

}  // namespace atrium::test_support
