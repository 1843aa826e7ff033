#include "viewer/start/start_screen.hpp"

#include "core/bus/limits.hpp"
#include "core/bus/names.hpp"
#include "viewer/ui/hud.hpp"
#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/ui_scale.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::array<const char*, 4> kNetworks{"loopback", "lan", "wifi", "wan"};
constexpr double kWorldsHeight_px = 240.0;  // at scale 1
constexpr double kNameWidth_px = 190.0;
constexpr double kScreenWidth_px = 820.0;

std::string id_of(const bus::BusOptions& world) {
    return fmt::format("{} {} {} {}", world.world, world.domain, world.network, world.peers);
}

std::string title_of(const bus::BusOptions& options) {
    return fmt::format("network {}, domain {}{}",
                       options.network,
                       options.domain,
                       options.peers.empty() ? "" : ", peers " + options.peers);
}

// Writes the name before the field that follows, on the same line where both have room.
void labelled_field(const char* name, double width_px) {
    const float gap = ui_px(16.0);
    const ImGuiStyle& style = ImGui::GetStyle();
    const float from = ImGui::GetItemRectMax().x + gap;
    const float width = ImGui::CalcTextSize(name).x + style.ItemSpacing.x + ui_px(width_px);
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    if (from + width <= right) ImGui::SameLine(0.0f, gap);
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(name);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ui_px(width_px));
}

}  // namespace

std::vector<WorldEntry> world_entries(const bus::BusOptions& options,
                                      const std::vector<presence::HeardWorld>& heard,
                                      const std::vector<bus::BusOptions>& recent) {
    std::vector<WorldEntry> entries;
    for (const presence::HeardWorld& world : heard) {
        WorldEntry entry{options, presence::describe(world), true};
        entry.options.world = world.name;
        entries.push_back(std::move(entry));
    }
    for (const bus::BusOptions& world : recent) {
        const bool is_heard = std::ranges::any_of(entries, [&](const WorldEntry& entry) {
            return entry.is_heard && entry.options.world == world.world &&
                   entry.options.domain == world.domain && entry.options.network == world.network;
        });
        if (is_heard) continue;
        WorldEntry entry{world, "joined before; not heard now", false};
        entry.options.profiles_file = options.profiles_file;
        const bool is_elsewhere =
            world.domain != options.domain || world.network != options.network;
        if (is_elsewhere) entry.text = "joined before; " + title_of(world);
        entries.push_back(std::move(entry));
    }
    return entries;
}

void draw_joining(const std::string& world) {
    begin_panel("joining", Corner::kMiddle, 0.96, PanelKind::kText);
    ImGui::Text("joining %s ...", world.c_str());
    ImGui::End();
}

StartScreen::StartScreen(bus::BusOptions options, std::string notice)
    : options_(std::move(options)),
      notice_(std::move(notice)),
      domain_(static_cast<int>(options_.domain)) {
    std::copy_n(
        options_.peers.begin(), std::min(options_.peers.size(), peers_.size() - 1), peers_.begin());
}

void StartScreen::choose_by_key(const std::vector<WorldEntry>& worlds) {
    if (ImGui::GetIO().WantTextInput) return;
    const double now_s = ImGui::GetTime();
    if (is_pressed(ImGuiKey_Escape) && !close_popup())
        is_left_ = asked_.is_confirmed(Action::kClose, now_s);
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) asked_.take_back();
    if (worlds.empty()) return;
    const auto found = std::ranges::find_if(
        worlds, [&](const WorldEntry& world) { return id_of(world.options) == chosen_; });
    const auto last = static_cast<std::ptrdiff_t>(worlds.size()) - 1;
    std::ptrdiff_t at = found == worlds.end() || !has_chosen_ ? 0 : found - worlds.begin();
    const int step =
        (is_pressed(ImGuiKey_DownArrow) ? 1 : 0) - (is_pressed(ImGuiKey_UpArrow) ? 1 : 0);
    at += step;
    has_chosen_ |= step != 0;
    const WorldEntry& world =
        worlds[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(at, 0, last))];
    chosen_ = id_of(world.options);
    if (is_pressed(ImGuiKey_Delete) && !world.is_heard) forgotten_ = world.options;
    if (is_pressed(ImGuiKey_Enter) || is_pressed(ImGuiKey_KeyPadEnter)) joined_ = world.options;
}

void StartScreen::draw_list(const std::vector<WorldEntry>& worlds) {
    const auto num_heard = std::ranges::count_if(worlds, &WorldEntry::is_heard);
    ImGui::Text("%s: %td %s heard",
                title_of(options_).c_str(),
                num_heard,
                num_heard == 1 ? "world is" : "worlds are");
    const WorldEntry* chosen = nullptr;
    if (ImGui::BeginListBox("##worlds", {-1.0f, ui_px(kWorldsHeight_px)})) {
        if (num_heard == 0) {
            ImGui::TextColored(
                kHintColour,
                "Nothing yet. Start a world: \"atrium demo\", or a world_server and a site_node "
                "on this network and domain.");
        }
        for (const WorldEntry& world : worlds) {
            const std::string id = id_of(world.options);
            const std::string title = fmt::format("{}###{}", world.options.world, id);
            if (!world.is_heard) ImGui::PushStyleColor(ImGuiCol_Text, kHintColour);
            if (ImGui::Selectable(
                    title.c_str(), id == chosen_, ImGuiSelectableFlags_AllowDoubleClick)) {
                chosen_ = id;
                has_chosen_ = true;
                if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) joined_ = world.options;
            }
            ImGui::SameLine(ui_px(kNameWidth_px));
            ImGui::TextUnformatted(world.text.c_str());
            if (!world.is_heard) ImGui::PopStyleColor();
            if (id == chosen_) chosen = &world;
        }
        ImGui::EndListBox();
    }
    ImGui::BeginDisabled(chosen == nullptr);
    const std::string title =
        chosen == nullptr ? "join###join" : fmt::format("join {}###join", chosen->options.world);
    if (ImGui::Button(title.c_str()) && chosen != nullptr) joined_ = chosen->options;
    ImGui::EndDisabled();
    if (chosen == nullptr || chosen->is_heard) return;
    ImGui::SameLine();
    if (ImGui::Button("forget it")) forgotten_ = chosen->options;
}

void StartScreen::draw_network() {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Listen on");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ui_px(130.0));
    if (ImGui::BeginCombo("##network", options_.network.c_str())) {
        for (const char* network : kNetworks)
            if (ImGui::Selectable(network, options_.network == network)) options_.network = network;
        ImGui::EndCombo();
    }
    labelled_field("domain", 120.0);
    // only when the number is complete: each change leaves a domain and joins another
    ImGui::InputInt("##domain", &domain_);
    const bool is_domain = domain_ >= 0 && static_cast<std::uint32_t>(domain_) <= bus::kMaxDomain;
    if (ImGui::IsItemDeactivatedAfterEdit() && is_domain)
        options_.domain = static_cast<std::uint32_t>(domain_);
    labelled_field("peers", 200.0);
    ImGui::InputTextWithHint("##peers", "host,host", peers_.data(), peers_.size());
    if (ImGui::IsItemDeactivatedAfterEdit()) options_.peers = peers_.data();
    if (!is_domain)
        ImGui::TextColored(kWarningColour, "the domain must be 0 to %u", bus::kMaxDomain);
    if (!failure_.empty()) ImGui::TextColored(kWarningColour, "%s", failure_.c_str());
}

void StartScreen::draw_other() {
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted("Another world");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ui_px(200.0));
    const bool is_entered = ImGui::InputTextWithHint(
        "##other", "name", other_.data(), other_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
    const bool is_valid = bus::is_valid_name(other_.data());
    ImGui::SameLine();
    ImGui::BeginDisabled(!is_valid);
    const bool is_clicked = ImGui::Button("join it");
    ImGui::EndDisabled();
    if (is_valid && (is_entered || is_clicked)) {
        joined_ = options_;
        joined_->world = other_.data();
    }
    if (!is_valid && other_[0] != '\0')
        ImGui::TextColored(kWarningColour, "names have 1 to 63 characters of A-Z a-z 0-9 _ . -");
}

void StartScreen::draw(const std::vector<WorldEntry>& worlds) {
    choose_by_key(worlds);
    const float width = std::min(ui_px(kScreenWidth_px), 0.95f * ImGui::GetIO().DisplaySize.x);
    ImGui::SetNextWindowSize({width, 0.0f});
    begin_panel("start", Corner::kMiddle, 0.96);
    ImGui::PushTextWrapPos(width - ui_px(20.0));
    ImGui::TextColored(kWarningColour, "Atrium: choose a world");
    if (!notice_.empty()) ImGui::TextColored(kWarningColour, "%s", notice_.c_str());
    draw_list(worlds);
    ImGui::Separator();
    draw_network();
    draw_other();
    ImGui::Separator();
    ImGui::TextColored(kHintColour,
                       "Not heard: worlds of other domains and networks, of hosts beyond a router "
                       "(name them as peers), and of other versions of Atrium.");
    ImGui::TextColored(
        kHintColour,
        "Up, Down: choose   Enter: join   Delete: forget   F11: full screen   Esc twice: quit");
    ImGui::PopTextWrapPos();
    ImGui::End();
    if (const auto asked = asked_.action(ImGui::GetTime())) draw_question(*asked);
}

}  // namespace atrium::viewer
