#pragma once

#include "core/bus/messages.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Sends the edits of one viewer, watches their results, and undoes and redoes them. The world
/// server decides: an edit is undone only if nobody else has edited the object since.
class EditHistory {
public:
    using Clock = std::chrono::steady_clock;
    using Edits = std::vector<bus::SceneEdit>;
    static constexpr std::chrono::milliseconds kPatience{2500};

    /// State of an object before or after an edit.
    struct Object {
        bus::SceneObject object;
        geometry::RigidTransform pose;
    };
    /// An edit that can be undone.
    struct Step {
        bus::EditKind kind = bus::EditKind::kChange;  // kAdd, kChange, kPlace, kRemove
        std::uint32_t object = 0;
        std::string name;
        Object before;  // kChange, kPlace, kRemove
        Object after;   // kAdd, kChange, kPlace
    };

    explicit EditHistory(std::string sender) : sender_(std::move(sender)) {}

    /// Returns an edit with sender and number; it is not watched.
    bus::SceneEdit edit(bus::EditKind kind, std::uint32_t target);
    bus::SceneEdit add(const bus::SceneObject& object, Clock::time_point now);
    bus::SceneEdit remove(const Object& object, Clock::time_point now);
    bus::SceneEdit change(const Object& before,
                          const bus::SceneObject& after,
                          Clock::time_point now);
    bus::SceneEdit place(const Object& before,
                         const geometry::RigidTransform& pose,
                         Clock::time_point now);
    bus::SceneEdit save_world(const std::string& name, Clock::time_point now);
    bus::SceneEdit load_world(const std::string& name, Clock::time_point now);

    /// Requests carried out by `update`, one at a time and in order.
    void want_undo() { want(true); }
    void want_redo() { want(false); }

    /// Takes results; returns what the user should read. A result that comes after "no result" was
    /// said corrects it. `has_server`: a world server that knows
    /// edits is there.
    std::vector<std::string> take(const std::vector<bus::EditResult>& results,
                                  bool has_server,
                                  Clock::time_point now);
    /// Returns the next wanted undo or redo, if none is under way. `texts` gets a line if there is
    /// nothing to undo.
    std::optional<bus::SceneEdit> next(Clock::time_point now, std::vector<std::string>& texts);

    /// Whether this viewer has removed the object, or asks for it: with an edit, its undo or redo.
    bool has_removed(std::uint32_t object) const;
    /// Object that the last finished edit added or brought back, once. 0: none.
    std::uint32_t take_added();
    /// An object was added whose result has not come yet.
    bool is_adding() const;
    const Step* undo_step() const { return undone_from_.empty() ? nullptr : &undone_from_.back(); }
    const Step* redo_step() const { return redone_from_.empty() ? nullptr : &redone_from_.back(); }

private:
    enum class As : std::uint8_t { kNew, kUndo, kRedo };
    struct Pending {
        std::uint32_t number = 0;
        bus::EditKind kind = bus::EditKind::kChange;
        Clock::time_point since;
        As as = As::kNew;
        std::optional<Step> step;  // none: it cannot be undone
        std::string what;          // "moved ball", for the user
    };
    void want(bool undo);
    bus::SceneEdit watch(bus::SceneEdit edit,
                         As as,
                         std::optional<Step> step,
                         std::string what,
                         Clock::time_point now);
    bus::SceneEdit opposite(const Step& step, As as);
    void finish(Pending& pending, const bus::EditResult& result);
    static bool removes(const Step& step, As as);
    std::string text_of(const Pending& pending, const bus::EditResult& result) const;
    std::string take_answered(std::vector<Pending>& from,
                              std::size_t at,
                              const bus::EditResult& result);

    std::string sender_;
    std::uint32_t last_number_ = 0;
    std::vector<Pending> pending_;   // oldest first
    std::vector<Pending> late_;      // without a result when it was due; oldest first
    std::vector<Step> undone_from_;  // oldest first
    std::vector<Step> redone_from_;
    std::deque<bool> wanted_;                           // true: undo
    std::map<std::uint32_t, std::uint32_t> revisions_;  // of objects after this viewer's last edit
    std::uint32_t added_ = 0;
    std::uint32_t removed_ = 0;  // by this viewer, last
};

}  // namespace atrium::viewer
