#include "core/keys/member.hpp"

#include "core/base/valid_name.hpp"

#include <fmt/format.h>

namespace atrium::keys {
namespace {

constexpr std::array<std::string_view, 4> kKindTexts{"site", "viewer", "world", "monitor"};
constexpr std::array<std::string_view, 8> kRightTexts{
    "add", "remove", "reset", "push", "grab", "edit", "save", "record"};

std::optional<Right> find_right(std::string_view text) {
    for (std::size_t i = 0; i < kRightTexts.size(); ++i)
        if (kRightTexts[i] == text) return static_cast<Right>(i);
    return std::nullopt;
}

}  // namespace

std::string_view kind_text(Kind kind) { return kKindTexts[static_cast<std::size_t>(kind)]; }

std::optional<Kind> find_kind(std::string_view text) {
    for (const Kind kind : kKinds)
        if (kind_text(kind) == text) return kind;
    return std::nullopt;
}

Rights Rights::all() {
    Rights rights;
    for (std::size_t i = 0; i < kRightTexts.size(); ++i) rights.add(static_cast<Right>(i));
    return rights;
}

std::string rights_text(Rights rights) {
    std::string text;
    for (std::size_t i = 0; i < kRightTexts.size(); ++i) {
        if (!rights.has(static_cast<Right>(i))) continue;
        if (!text.empty()) text += '+';
        text += kRightTexts[i];
    }
    return text.empty() ? "none" : text;
}

Expected<Rights> rights_of_text(std::string_view text) {
    Rights rights;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find('+', begin), text.size());
        if (const auto right = find_right(text.substr(begin, end - begin))) rights.add(*right);
        begin = end + 1;
    }
    // whatever has another order, a word twice or an unknown one is not written this way
    if (rights_text(rights) != text)
        return make_error(ErrorKind::kInvalidData, "the text of the rights is damaged");
    return rights;
}

Expected<Rights> parse_rights(std::string_view text) {
    if (text == "none") return Rights();
    Rights rights;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find_first_of(",+", begin), text.size());
        std::string_view word = text.substr(begin, end - begin);
        word.remove_prefix(std::min(word.find_first_not_of(' '), word.size()));
        word = word.substr(0, word.find_last_not_of(' ') + 1);
        if (word == "all") {
            rights = Rights::all();
        } else if (const auto right = find_right(word)) {
            rights.add(*right);
        } else {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("rights: '{}' must be some of {} with commas between "
                                          "them, or all, or none",
                                          word,
                                          fmt::join(kRightTexts, ", ")));
        }
        begin = end + 1;
    }
    return rights;
}

Expected<void> check_key_name(std::string_view name, std::string_view what) {
    if (is_valid_name(name) && name.front() != '.') return {};
    // the name may come from a file: only a part of it goes to the terminal
    std::string shown(name.substr(0, kMaxNameLength));
    for (char& c : shown)
        if (c < ' ' || c > '~') c = '?';
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("the name of {} must have 1 to {} characters of A-Z a-z 0-9 _ . "
                                  "- and not begin with a dot, got '{}'",
                                  what,
                                  kMaxNameLength,
                                  shown));
}

Expected<void> check(const Member& member) {
    if (auto fine = check_key_name(member.world, "the world"); !fine) return fine;
    const std::string what = "the " + std::string(kind_text(member.kind));
    if (auto fine = check_key_name(member.name, what); !fine) return fine;
    const bool may_have_rights = member.kind == Kind::kViewer || member.kind == Kind::kMonitor;
    if (!may_have_rights && !member.rights.is_empty())
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{} cannot have rights: only viewers and monitors have", what));
    return {};
}

std::string subject_of(const Member& member) {
    return fmt::format("CN={},OU={},O={}", member.name, kind_text(member.kind), member.world);
}

std::optional<Member> member_of_subject(std::string_view subject) {
    const std::string_view given = subject;
    const auto next = [&subject](std::string_view key) -> std::string_view {
        if (!subject.starts_with(key)) return {};
        subject.remove_prefix(key.size());
        const std::string_view word = subject.substr(0, subject.find(','));
        subject.remove_prefix(std::min(subject.size(), word.size() + 1));
        return word;
    };
    Member member;
    member.name = next("CN=");
    const auto kind = find_kind(next("OU="));
    member.world = next("O=");
    if (!kind) return std::nullopt;
    member.kind = *kind;
    // other texts may lead to the same member
    if (!check(member) || subject_of(member) != given) return std::nullopt;
    return member;
}

std::string describe(const Member& member) {
    // of that kind there is one, which has the world's name
    if (member.kind == Kind::kWorld) return "world server of world " + member.world;
    return fmt::format("{} {} of world {}", kind_text(member.kind), member.name, member.world);
}

}  // namespace atrium::keys
