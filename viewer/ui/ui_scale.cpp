#include "viewer/ui/ui_scale.hpp"

#include "core/app/log.hpp"
#include "viewer/overlay/label_scale.hpp"

#include <imgui.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace atrium::viewer {
namespace {

constexpr double kScaleStep = 0.25;
constexpr double kMaxUiScale = 8.0;
constexpr double kLeastWidth_px = 720.0;    // for the panels at scale 1
constexpr double kLetter_px = 16.0;         // size of the font at scale 1
constexpr double kBuiltInLetter_px = 13.0;  // ImGui's own font is made for this size
// Debian's fonts-dejavu-core, and the place of other distributions
constexpr std::array<const char*, 3> kFonts{"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                            "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                                            "/usr/share/fonts/TTF/DejaVuSans.ttf"};

const char* font_file() {
    for (const char* file : kFonts) {
        std::error_code failure;
        if (std::filesystem::is_regular_file(file, failure)) return file;
    }
    return nullptr;
}

}  // namespace

double ui_scale_of(double wanted, const std::array<int, 2>& size_px, double content_scale) {
    if (wanted > 0.0) return std::min(wanted, kMaxUiScale);
    const double of_picture =
        std::min(size_px[1] / kReferenceHeight_px, size_px[0] / kLeastWidth_px);
    const double scale = std::max({1.0, content_scale, of_picture});
    return std::min(kMaxUiScale, std::floor(scale / kScaleStep) * kScaleStep);
}

void UiSizes::set_scale(double scale) {
    if (scale_ == scale) return;
    const bool is_first = !scale_;
    scale_ = scale;
    ImGui::GetStyle() = ImGuiStyle();
    // else the box of an unticked field cannot be seen on a panel
    ImGui::GetStyle().FrameBorderSize = 1.0f;
    ImGui::GetStyle().Colors[ImGuiCol_Border] = {0.55f, 0.6f, 0.68f, 0.6f};
    ImGui::GetStyle().ScaleAllSizes(static_cast<float>(scale));
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    fonts.Clear();
    // Latin, Greek, Cyrillic, and marks such as dashes and the euro: as people type them
    static constexpr std::array<ImWchar, 9> kLetters{
        0x20, 0x17f, 0x370, 0x52f, 0x2010, 0x205e, 0x20a0, 0x20bf, 0};
    const char* file = font_file();
    const auto size_px = static_cast<float>(std::round(kLetter_px * scale));
    if (file == nullptr ||
        fonts.AddFontFromFileTTF(file, size_px, nullptr, kLetters.data()) == nullptr) {
        // without fractions of its pixels, which would blur it
        ImFontConfig built_in;
        built_in.SizePixels =
            static_cast<float>(kBuiltInLetter_px * std::max(1.0, std::floor(scale)));
        fonts.AddFontDefault(&built_in);
        if (is_first)
            app::log::info("font_built_in reason=\"no DejaVuSans.ttf; install fonts-dejavu-core\"");
    }
    ImGui_ImplOpenGL3_DestroyFontsTexture();
    ImGui_ImplOpenGL3_CreateFontsTexture();
}

float ui_px(double at_scale_1_px) {
    return static_cast<float>(at_scale_1_px / kLetter_px) * ImGui::GetFontSize();
}

}  // namespace atrium::viewer
