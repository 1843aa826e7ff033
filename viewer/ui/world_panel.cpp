#include "viewer/ui/edit_panel.hpp"
#include "viewer/ui/fields.hpp"
#include "viewer/ui/local_time.hpp"
#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/ui_scale.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr float kListLines = 5.0f;
constexpr int kFramesToShow = 3;           // the menu takes one or two to grow
constexpr double kLargestUsual_m = 10.0;   // of a model in a room
constexpr double kPreviewPixel_px = 1.25;  // at scale 1

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
    });
    return text;
}

bool begin_list(const char* name) {
    return ImGui::BeginListBox(name, {-1.0f, kListLines * ImGui::GetTextLineHeightWithSpacing()});
}

// Draws rows of equal greys as bars: a picture this small needs no texture.
void draw_preview_picture(const ModelPreview& preview) {
    if (preview.greys.empty()) return;
    const float pixel = ui_px(kPreviewPixel_px);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (int y = 0; y < ModelPreview::kHeight; ++y) {
        const auto* row = &preview.greys[static_cast<std::size_t>(y * ModelPreview::kWidth)];
        for (int x = 0; x < ModelPreview::kWidth;) {
            const int from = x;
            while (x < ModelPreview::kWidth && row[x] == row[from]) ++x;
            if (row[from] == ModelPreview::kBackground) continue;
            list.AddRectFilled(
                {at.x + pixel * static_cast<float>(from), at.y + pixel * static_cast<float>(y)},
                {at.x + pixel * static_cast<float>(x), at.y + pixel * static_cast<float>(y + 1)},
                IM_COL32(row[from], row[from], row[from], 255));
        }
    }
    ImGui::Dummy({pixel * ModelPreview::kWidth, pixel * ModelPreview::kHeight});
}

void draw_measured(const ModelSize* size, double scale) {
    if (size == nullptr) return ImGui::TextUnformatted("reading the model ...");
    if (!size->error.empty()) return draw_wrapped(size->error);
    const Eigen::Vector3d scaled = scale * size->size_m;
    draw_preview_picture(size->preview);
    ImGui::TextWrapped("%.2f x %.2f x %.2f m, %zu triangles, %zu part%s",
                       scaled.x(),
                       scaled.y(),
                       scaled.z(),
                       size->num_triangles,
                       size->num_parts,
                       size->num_parts == 1 ? "" : "s");
    if (size->colours.size() > 1)
        draw_wrapped(fmt::format("its {} colours are drawn in one grey", size->colours.size()));
    if (scaled.maxCoeff() <= kLargestUsual_m) return;
    const double in_cm_m = 0.01 * scaled.maxCoeff();
    ImGui::TextColored(kHintColour,
                       "larger than a room: scale %g?",
                       scale * (in_cm_m <= kLargestUsual_m ? 0.01 : 0.001));
}

void draw_size(const ModelSize* size, double scale) {
    const float below = ImGui::GetCursorPosY() + ui_px(kPreviewPixel_px * ModelPreview::kHeight) +
                        4.0f * ImGui::GetTextLineHeightWithSpacing();
    draw_measured(size, scale);
    // the fields below stay where they are while models are read
    ImGui::SetCursorPosY(std::max(below, ImGui::GetCursorPosY()));
}

}  // namespace

void WorldPanel::draw_models(const HudContent& content, SurfaceEvents& events) {
    events.show_models = true;
    ImGui::InputText("search", filter_.data(), filter_.size());
    const std::string filter = lower(filter_.data());
    if (begin_list("##models")) {
        if (content.models == nullptr)
            ImGui::TextUnformatted("reading the folder ...");
        else if (content.models->empty())
            draw_wrapped("no models in " + content.models_folder +
                         " (another folder: --viewer.models)");
        bool has_any = content.models == nullptr || content.models->empty();
        for (const ModelEntry& entry :
             content.models ? *content.models : std::vector<ModelEntry>{}) {
            if (lower(entry.file).find(filter) == std::string::npos) continue;
            has_any = true;
            if (!entry.problem.empty()) {
                ImGui::TextDisabled("%s: %s", entry.file.c_str(), entry.problem.c_str());
                continue;
            }
            if (ImGui::Selectable(entry.file.c_str(), entry.file == model_)) {
                // of another model neither scale nor mass is right
                if (entry.file != model_) scale_ = mass_kg_ = 1.0f;
                model_ = entry.file;
                frames_to_show_ = kFramesToShow;
            }
        }
        if (!has_any) draw_wrapped(fmt::format("no model has '{}' in its name", filter_.data()));
        ImGui::EndListBox();
    }
    events.measure_model = model_;
    if (model_.empty()) return;
    const bool is_measured = content.model_size && content.measured_model == model_;
    draw_size(is_measured ? &*content.model_size : nullptr, static_cast<double>(scale_));
    const auto number = [&](const char* title, float& value, const NumberRange& range) {
        if (std::string problem = number_field(title, {&value, 1}, range); !problem.empty())
            events.edit.hint = std::move(problem);
    };
    number("scale", scale_, {0.0001f, 10000.0f, "%.4f"});
    const Eigen::Vector3d size_m =
        is_measured ? Eigen::Vector3d(static_cast<double>(scale_) * content.model_size->size_m)
                    : Eigen::Vector3d::Zero();
    number("mass##model", mass_kg_, masses_of(bus::Shape::kConvex, size_m, 0.0));
    ImGui::Checkbox("fixed##model", &is_fixed_);
    ImGui::SameLine();
    ImGui::Checkbox("hull of each part", &is_compound_);
    ImGui::BeginDisabled(!is_measured || !content.model_size->error.empty());
    if (ImGui::Button("add this model before the eye", {-1.0f, 0.0f}) && is_measured) {
        NewModel wanted;
        wanted.file = model_;
        wanted.scale = static_cast<double>(scale_);
        wanted.is_compound = is_compound_;
        wanted.mass_kg = is_fixed_ ? 0.0 : static_cast<double>(mass_kg_);
        wanted.size_m = content.model_size->size_m;
        if (content.model_size->colours.size() == 1)
            wanted.colour = content.model_size->colours.front();
        events.edit.add_model = wanted;
    }
    ImGui::EndDisabled();
    show_lowest();
}

// A menu that has just become longer scrolls to its new end.
void WorldPanel::show_lowest() {
    if (frames_to_show_ == 0) return;
    --frames_to_show_;
    ImGui::SetScrollHereY(1.0f);
}

void WorldPanel::draw_worlds(const HudContent& content, SurfaceEvents& events) {
    const auto& worlds = content.edit.worlds;
    if (!worlds) return draw_wrapped("No world server that knows saved worlds is running.");
    if (!worlds->is_on)
        return draw_wrapped(
            "The world server has no folder of saved worlds (its option world.saved_folder).");
    if (begin_list("##worlds")) {
        for (const bus::SavedWorld& world : worlds->worlds) {
            if (!ImGui::Selectable(world.name.c_str(), world.name == world_)) continue;
            world_ = world.name;
            asks_load_ = asks_save_ = false;
            std::snprintf(world_name_.data(), world_name_.size(), "%s", world_.c_str());
        }
        ImGui::EndListBox();
    }
    // below the list: beside the name it would be cut
    const auto chosen = std::find_if(worlds->worlds.begin(),
                                     worlds->worlds.end(),
                                     [&](const auto& w) { return w.name == world_; });
    // always a line, so that a second click hits the same button
    if (chosen != worlds->worlds.end())
        ImGui::Text("%zu objects, saved %s",
                    static_cast<std::size_t>(chosen->num_objects),
                    local_time_text(chosen->time).c_str());
    else
        ImGui::TextDisabled("choose one to load it");
    ImGui::BeginDisabled(world_.empty());
    // loading replaces what everybody sees
    const char* title = asks_load_ ? "replace everybody's world?" : "load this world";
    if (ImGui::Button((std::string(title) + "###load").c_str(), {-1.0f, 0.0f})) {
        if (asks_load_) events.edit.load_world = world_;
        asks_load_ = !asks_load_;
        asks_save_ = false;
    }
    bool is_over_button = ImGui::IsItemHovered();
    ImGui::EndDisabled();
    const std::array<char, 64> before = world_name_;
    name_field("name##world", world_name_);
    if (before != world_name_) asks_save_ = false;
    ImGui::BeginDisabled(world_name_[0] == '\0');
    const bool is_known = std::any_of(worlds->worlds.begin(),
                                      worlds->worlds.end(),
                                      [&](const auto& w) { return w.name == world_name_.data(); });
    // as for loading: a saved world does not come back
    const char* save_title = !is_known    ? "save the world###save"
                             : asks_save_ ? "replace the saved world?###save"
                                          : "save over it###save";
    if (ImGui::Button(save_title, {-1.0f, 0.0f})) {
        asks_save_ = is_known && !asks_save_;
        asks_load_ = false;
        if (!asks_save_) events.edit.save_world = world_name_.data();
    }
    is_over_button = is_over_button || ImGui::IsItemHovered();
    ImGui::EndDisabled();
    // a click anywhere else takes the question back
    if (asks() && ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !is_over_button) take_back();
    show_lowest();
}

void WorldPanel::draw(const HudContent& content, SurfaceEvents& events) {
    if (ImGui::CollapsingHeader("models")) draw_models(content, events);
    if (std::exchange(wants_worlds_, false)) {
        ImGui::SetNextItemOpen(true);
        frames_to_show_ = kFramesToShow;
    }
    const bool are_worlds_open = ImGui::CollapsingHeader("saved worlds");
    if (are_worlds_open && !were_worlds_open_) frames_to_show_ = kFramesToShow;
    were_worlds_open_ = are_worlds_open;
    if (are_worlds_open) draw_worlds(content, events);
}

}  // namespace atrium::viewer
