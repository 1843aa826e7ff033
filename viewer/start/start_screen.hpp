#pragma once

#include "core/bus/bus.hpp"
#include "core/presence/heard_worlds.hpp"
#include "viewer/start/recent_worlds.hpp"
#include "viewer/ui/asked_again.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// A world that the user can join.
struct WorldEntry {
    bus::BusOptions options;
    std::string text;       // who is in it
    bool is_heard = false;  // else only remembered
};

/// The worlds heard with `options`, and then those of `recent` that are not among them.
std::vector<WorldEntry> world_entries(const bus::BusOptions& options,
                                      const std::vector<presence::HeardWorld>& heard,
                                      const std::vector<bus::BusOptions>& recent);

/// Lays out a message while a world is joined. Inside an ImGui frame.
void draw_joining(const std::string& world);

/// The start screen: lists worlds, and lets the user choose one and the network to listen on. Knows
/// no bus and no window.
class StartScreen {
public:
    /// `notice`: message for the user, for example why a world could not be joined.
    StartScreen(bus::BusOptions options, std::string notice);

    /// Lays out the screen. Inside an ImGui frame.
    void draw(const std::vector<WorldEntry>& worlds);

    /// The network to listen on. `world` is without meaning.
    const bus::BusOptions& options() const { return options_; }
    /// Shows why the network cannot be listened on; empty: it can.
    void set_failure(const std::string& failure) { failure_ = failure; }
    const std::optional<bus::BusOptions>& joined() const { return joined_; }
    bool is_left() const { return is_left_; }
    /// Takes the remembered world that the user removes from the list.
    std::optional<bus::BusOptions> take_forgotten() { return std::exchange(forgotten_, {}); }

private:
    void choose_by_key(const std::vector<WorldEntry>& worlds);
    void draw_list(const std::vector<WorldEntry>& worlds);
    void draw_network();
    void draw_other();

    bus::BusOptions options_;
    std::string notice_;
    std::string failure_;
    std::string chosen_;       // a world of the list
    bool has_chosen_ = false;  // the user did; else the first one is chosen
    std::array<char, 64> other_{};
    std::array<char, 256> peers_{};
    int domain_ = 0;
    std::optional<bus::BusOptions> joined_;
    std::optional<bus::BusOptions> forgotten_;
    bool is_left_ = false;
    AskedAgain asked_;  // before Esc ends the viewer
};

}  // namespace atrium::viewer
