#include "viewer/control/edit_history.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::size_t kMaxSteps = 200;
constexpr std::size_t kMaxPending = 64;
constexpr std::size_t kMaxWanted = 32;

const char* done_word(bus::EditKind kind) {
    switch (kind) {
        case bus::EditKind::kAdd:
            return "added";
        case bus::EditKind::kRemove:
            return "removed";
        case bus::EditKind::kPlace:
            return "placed";
        case bus::EditKind::kSaveWorld:
            return "saved";
        case bus::EditKind::kLoadWorld:
            return "loaded";
        default:
            return "changed";
    }
}

// What differs, as it is now: "3 kg, friction 0.5".
std::string new_values(const bus::SceneObject& before, const bus::SceneObject& now) {
    std::vector<std::string> values;
    if (now.mass_kg != before.mass_kg)
        values.push_back(now.mass_kg == 0.0 ? "fixed" : fmt::format("{:.3g} kg", now.mass_kg));
    if (now.friction != before.friction)
        values.push_back(fmt::format("friction {:.3g}", now.friction));
    if (now.restitution != before.restitution)
        values.push_back(fmt::format("bounce {:.3g}", now.restitution));
    if (now.colour != before.colour) values.emplace_back("its colour");
    if (now.texture != before.texture) values.emplace_back("its texture");
    if (now.size_m != before.size_m) {
        values.push_back(fmt::format(
            "{:.3g} x {:.3g} x {:.3g} m", now.size_m.x(), now.size_m.y(), now.size_m.z()));
    }
    return values.empty() ? "as it was" : fmt::format("{}", fmt::join(values, ", "));
}

void push_bounded(std::vector<EditHistory::Step>& steps, EditHistory::Step step) {
    if (steps.size() >= kMaxSteps) steps.erase(steps.begin());
    steps.push_back(std::move(step));
}

}  // namespace

bus::SceneEdit EditHistory::edit(bus::EditKind kind, std::uint32_t target) {
    bus::SceneEdit edit;
    edit.sender = sender_;
    edit.kind = kind;
    edit.number = ++last_number_;
    edit.target = target;
    return edit;
}

bus::SceneEdit EditHistory::watch(
    bus::SceneEdit edit, As as, std::optional<Step> step, std::string what, Clock::time_point now) {
    if (pending_.size() >= kMaxPending) pending_.erase(pending_.begin());
    pending_.push_back({edit.number, edit.kind, now, as, std::move(step), std::move(what)});
    return edit;
}

bus::SceneEdit EditHistory::add(const bus::SceneObject& object, Clock::time_point now) {
    bus::SceneEdit add = edit(bus::EditKind::kAdd, 0);
    add.object = object;
    Step step{bus::EditKind::kAdd, 0, object.name, {}, {object, object.world_from_object}};
    return watch(std::move(add), As::kNew, std::move(step), object.name, now);
}

bus::SceneEdit EditHistory::remove(const Object& object, Clock::time_point now) {
    const std::uint32_t id = object.object.object;
    Step step{bus::EditKind::kRemove, id, object.object.name, object, {}};
    return watch(
        edit(bus::EditKind::kRemove, id), As::kNew, std::move(step), object.object.name, now);
}

bus::SceneEdit EditHistory::change(const Object& before,
                                   const bus::SceneObject& after,
                                   Clock::time_point now) {
    bus::SceneEdit change = edit(bus::EditKind::kChange, before.object.object);
    change.object = after;
    Step step{bus::EditKind::kChange,
              before.object.object,
              before.object.name,
              before,
              {after, before.pose}};
    return watch(std::move(change), As::kNew, std::move(step), after.name, now);
}

bus::SceneEdit EditHistory::place(const Object& before,
                                  const geometry::RigidTransform& pose,
                                  Clock::time_point now) {
    bus::SceneEdit place = edit(bus::EditKind::kPlace, before.object.object);
    place.object = before.object;
    place.object.world_from_object = pose;
    place.world_from_object = pose;
    Step step{bus::EditKind::kPlace,
              before.object.object,
              before.object.name,
              before,
              {place.object, pose}};
    return watch(std::move(place), As::kNew, std::move(step), before.object.name, now);
}

bus::SceneEdit EditHistory::save_world(const std::string& name, Clock::time_point now) {
    bus::SceneEdit save = edit(bus::EditKind::kSaveWorld, 0);
    save.world_file = name;
    return watch(std::move(save), As::kNew, std::nullopt, "world " + name, now);
}

bus::SceneEdit EditHistory::load_world(const std::string& name, Clock::time_point now) {
    bus::SceneEdit load = edit(bus::EditKind::kLoadWorld, 0);
    load.world_file = name;
    return watch(std::move(load), As::kNew, std::nullopt, "world " + name, now);
}

void EditHistory::want(bool undo) {
    if (wanted_.size() < kMaxWanted) wanted_.push_back(undo);
}

// The edit that undoes or redoes a step.
bus::SceneEdit EditHistory::opposite(const Step& step, As as) {
    const bool is_undo = as == As::kUndo;
    const bool removes = step.kind == (is_undo ? bus::EditKind::kAdd : bus::EditKind::kRemove);
    const bool adds = step.kind == (is_undo ? bus::EditKind::kRemove : bus::EditKind::kAdd);
    const Object& wanted = is_undo ? step.before : step.after;
    bus::SceneEdit edit = this->edit(removes ? bus::EditKind::kRemove
                                     : adds  ? bus::EditKind::kAdd
                                             : step.kind,
                                     step.object);
    const auto revision = revisions_.find(step.object);
    if (revision != revisions_.end()) edit.revision = revision->second;
    // the server knows the removed object; the message needs a valid one
    edit.object = adds ? (is_undo ? step.before : step.after).object : wanted.object;
    edit.world_from_object = wanted.pose;
    return edit;
}

std::optional<bus::SceneEdit> EditHistory::next(Clock::time_point now,
                                                std::vector<std::string>& texts) {
    if (wanted_.empty() || !pending_.empty()) return std::nullopt;
    const bool is_undo = wanted_.front();
    wanted_.pop_front();
    std::vector<Step>& steps = is_undo ? undone_from_ : redone_from_;
    if (steps.empty()) {
        texts.emplace_back(is_undo ? "nothing to undo" : "nothing to redo");
        return std::nullopt;
    }
    Step step = std::move(steps.back());
    steps.pop_back();
    const As as = is_undo ? As::kUndo : As::kRedo;
    bus::SceneEdit edit = opposite(step, as);
    std::string what = step.name;
    return watch(std::move(edit), as, std::move(step), std::move(what), now);
}

std::string EditHistory::text_of(const Pending& pending, const bus::EditResult& result) const {
    const bus::EditKind kind = pending.step ? pending.step->kind : pending.kind;
    const std::string what = fmt::format("{} {}", done_word(kind), pending.what);
    const char* as = pending.as == As::kUndo ? "undone" : "redone";
    if (pending.as == As::kNew) {
        return result.is_done
                   ? fmt::format("{} was {}", pending.what, done_word(kind))
                   : fmt::format("{} was not {}: {}", pending.what, done_word(kind), result.text);
    }
    if (result.is_done && kind == bus::EditKind::kChange) {
        const Step& step = *pending.step;
        const bool is_undo = pending.as == As::kUndo;
        return fmt::format("{}: {}: {}",
                           as,
                           what,
                           new_values(is_undo ? step.after.object : step.before.object,
                                      is_undo ? step.before.object : step.after.object));
    }
    return result.is_done ? fmt::format("{}: {}", as, what)
                          : fmt::format("not {}: {}: {}", as, what, result.text);
}

void EditHistory::finish(Pending& pending, const bus::EditResult& result) {
    if (!pending.step) return;
    Step step = std::move(*pending.step);
    if (!result.is_done) return;  // an undo that somebody else made impossible is dropped
    step.object = result.object;
    step.before.object.object = result.object;
    step.after.object.object = result.object;
    revisions_[result.object] = result.revision;
    const bool is_there = (step.kind == bus::EditKind::kAdd && pending.as != As::kUndo) ||
                          (step.kind == bus::EditKind::kRemove && pending.as == As::kUndo);
    if (is_there) added_ = result.object;
    if (is_there && removed_ == result.object) removed_ = 0;
    if (removes(step, pending.as)) removed_ = result.object;
    if (pending.as == As::kUndo) return push_bounded(redone_from_, std::move(step));
    push_bounded(undone_from_, std::move(step));
    if (pending.as == As::kNew) redone_from_.clear();
}

bool EditHistory::removes(const Step& step, As as) {
    return step.kind == (as == As::kUndo ? bus::EditKind::kAdd : bus::EditKind::kRemove);
}

bool EditHistory::has_removed(std::uint32_t object) const {
    return removed_ == object || std::ranges::any_of(pending_, [&](const Pending& pending) {
               return pending.step && pending.step->object == object &&
                      removes(*pending.step, pending.as);
           });
}

// What the user reads about the answer to an edit that is no longer watched then.
std::string EditHistory::take_answered(std::vector<Pending>& from,
                                       std::size_t at,
                                       const bus::EditResult& result) {
    Pending pending = std::move(from[at]);
    from.erase(from.begin() + static_cast<std::ptrdiff_t>(at));
    std::string text = text_of(pending, result);
    if (result.is_done && !result.text.empty()) text += ": " + result.text;
    finish(pending, result);
    return text;
}

std::vector<std::string> EditHistory::take(const std::vector<bus::EditResult>& results,
                                           bool has_server,
                                           Clock::time_point now) {
    std::vector<std::string> texts;
    for (const bus::EditResult& result : results) {
        const auto find_in = [&](const std::vector<Pending>& list) {
            return static_cast<std::size_t>(
                std::ranges::find(list, result.number, &Pending::number) - list.begin());
        };
        if (const std::size_t at = find_in(pending_); at < pending_.size()) {
            texts.push_back(take_answered(pending_, at, result));
        } else if (const std::size_t late = find_in(late_); late < late_.size()) {
            const auto after_s =
                std::chrono::duration_cast<std::chrono::seconds>(now - late_[late].since).count();
            texts.push_back(
                fmt::format("{} (late, after {} s)", take_answered(late_, late, result), after_s));
        } else {
            // not watched: a hold that was refused, the end of a cancelled drag, or a command,
            // whose answer has no number
            if (!result.is_done || result.number == 0) texts.push_back(result.text);
            if (result.is_done && result.revision > 0) revisions_[result.object] = result.revision;
        }
    }
    std::erase_if(pending_, [&](const Pending& pending) {
        if (now - pending.since < kPatience) return false;
        texts.push_back(fmt::format("{}: no result: {}",
                                    pending.what,
                                    has_server ? "the world server did not react"
                                               : "no world server that knows edits is running"));
        wanted_.clear();
        if (late_.size() >= kMaxPending) late_.erase(late_.begin());
        late_.push_back(pending);
        return true;
    });
    return texts;
}

bool EditHistory::is_adding() const {
    return std::ranges::any_of(
        pending_, [](const Pending& pending) { return pending.kind == bus::EditKind::kAdd; });
}

std::uint32_t EditHistory::take_added() { return std::exchange(added_, 0); }

}  // namespace atrium::viewer
