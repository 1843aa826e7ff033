#pragma once

#include "core/base/expected.hpp"

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

/// Makes and checks the keys of a world: certificates, permissions, bundles, the key store. Uses no
/// network. docs/design/security.md has the reasons.
namespace atrium::keys {

/// What a member of a world may be.
enum class Kind : std::uint8_t {
    kSite,
    kViewer,
    kWorld,    // a world server
    kMonitor,  // reads everything: monitor, record, doctor
};
inline constexpr std::array kKinds{Kind::kSite, Kind::kViewer, Kind::kWorld, Kind::kMonitor};

/// "site", "viewer", "world" or "monitor".
std::string_view kind_text(Kind kind);
/// The kind of this text; nullopt for any other.
std::optional<Kind> find_kind(std::string_view text);

/// A right to change the world. The first seven are the keys of `[rights]` of a world file.
enum class Right : std::uint8_t { kAdd, kRemove, kReset, kPush, kGrab, kEdit, kSave, kRecord };

/// A set of rights.
class Rights {
public:
    Rights() = default;
    Rights(std::initializer_list<Right> rights) {
        for (const Right right : rights) add(right);
    }
    static Rights all();

    void add(Right right) { bits_ = static_cast<std::uint8_t>(bits_ | bit(right)); }
    bool has(Right right) const { return (bits_ & bit(right)) != 0; }
    bool is_empty() const { return bits_ == 0; }
    bool operator==(const Rights&) const = default;

private:
    static unsigned bit(Right right) { return 1U << static_cast<unsigned>(right); }

    std::uint8_t bits_ = 0;
};

/// The names of the rights in the order of `Right`, joined by '+'; "none" for none. This text is
/// part of a partition: each set of rights has exactly one.
std::string rights_text(Rights rights);
/// The rights of a text that `rights_text` made. Fails with kInvalidData for any other text.
Expected<Rights> rights_of_text(std::string_view text);
/// Reads rights as users write them: names with commas (spaces may follow) or '+' between them, in
/// any order, "all" or "none".
/// Fails with kConfiguration and the valid names.
Expected<Rights> parse_rights(std::string_view text);

/// One owner of keys in one world.
struct Member {
    std::string world;
    Kind kind = Kind::kSite;
    std::string name;  // unique among all kinds of the world
    Rights rights;     // of viewers and monitors only
    bool operator==(const Member&) const = default;
};

/// Fails with kConfiguration if `name` is no valid name (core/base/valid_name.hpp) or begins with a
/// dot. `what` names it in the error, for example "the world".
Expected<void> check_key_name(std::string_view name, std::string_view what);

/// Checks both names, and that only viewers and monitors have rights. Fails with kConfiguration.
Expected<void> check(const Member& member);

/// The subject of the member's certificate as RFC 2253 text: "CN=alice,OU=site,O=playroom". Cyclone
/// DDS compares it with the subject in the permissions.
std::string subject_of(const Member& member);

/// The member of such a text, without rights; nullopt for any other text.
std::optional<Member> member_of_subject(std::string_view subject);

/// "site alice of world playroom", for messages.
std::string describe(const Member& member);

}  // namespace atrium::keys
