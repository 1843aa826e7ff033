#include "core/bus/bundle_change.hpp"

#include <fmt/format.h>

namespace atrium::bus {

std::string complaint_about(const keys::Bundle& now,
                            const keys::Bundle& own,
                            const std::string& file) {
    const keys::Member& theirs = now.member;
    const keys::Member& ours = own.member;
    const bool is_of_another =
        theirs.world != ours.world || theirs.kind != ours.kind || theirs.name != ours.name;
    if (is_of_another)
        return fmt::format(
            "bundle_of_another file={} it is the bundle of {}, and this program is {}: copy the "
            "right one there",
            file,
            describe(theirs),
            describe(ours));
    if (now.identity_ca != own.identity_ca)
        return fmt::format(
            "bundle_of_other_keys file={} it is of another key store of this world: start this "
            "program again to use it; the others need theirs",
            file);
    if (now.certificate != own.certificate)
        return fmt::format("bundle_has_a_new_key file={} start this program again to use it", file);
    return {};
}

}  // namespace atrium::bus
