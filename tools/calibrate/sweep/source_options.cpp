#include "tools/calibrate/sweep/source_options.hpp"

#include "core/base/write_check.hpp"
#include "site_node/preview/preview.hpp"

#include <fmt/format.h>

namespace atrium::calibrate {
namespace {

constexpr const char* kSiteGroup = "Pictures of cameras, as for site_node";
constexpr std::uint64_t kPreviewBytes = 8U << 20;

}  // namespace

SourceOptions::SourceOptions() {
    capture.source = "cameras";
    site_node::declare(capture, set_);
    simulation::declare(room, set_);
}

void SourceOptions::add_to(CLI::App& command, const std::string& shown) {
    command
        .add_option("--config",
                    config,
                    "file of a site with [capture] and [[capture.camera]]; its rig may be missing")
        ->type_name("FILE")
        ->group(kPicturesGroup);
    command
        .add_option_function<std::string>(
            "--preview",
            [this](const std::string& text) {
                preview = text.empty() ? std::string(preview::kWindow) : text;
            },
            fmt::format("show pictures, {} and what is covered, in a PNG written once a second or "
                        "in a \"window\"; without a value: a window, or preview.png if there is "
                        "no display",
                        shown))
        ->expected(0, 1)
        ->type_name("FILE")
        ->group(kPicturesGroup);
    for (const config::OptionSet::Entry& entry : set_.entries()) {
        auto* option = command.add_option_function<std::string>(
            "--" + entry.key,
            [this, key = entry.key, implicit_value = entry.implicit_value](
                const std::string& text) { given_[key] = text.empty() ? implicit_value : text; },
            entry.help);
        option
            ->type_name(fmt::format("({}; default {})",
                                    entry.type_name,
                                    entry.default_value.empty() ? "none" : entry.default_value))
            ->group(kSiteGroup);
        if (!entry.implicit_value.empty()) option->expected(0, 1);
    }
}

bool SourceOptions::is_asked() const {
    return !recording.empty() || !config.empty() || given_.contains("capture.source") ||
           given_.contains("capture.recording");
}

Expected<void> SourceOptions::resolve() {
    if (!config.empty()) {
        auto reader = config::TableReader::load(config);
        if (!reader) return tl::unexpected(reader.error());
        set_.read_file(*reader);
        site_node::read_cameras(*reader, capture.cameras);
        site_node::read_places(*reader, capture);
        reader->pass_over_others();  // of the site
        if (auto done = reader->finish(); !done) return done;
    }
    for (const auto& [key, text] : given_)
        if (auto set = set_.set(key, text, "--" + key); !set) return set;
    if (!recording.empty()) {
        capture.source = "recording";
        capture.recording = recording;
    }
    if (auto checked = check(capture); !checked) return checked;
    if (capture.source != "cameras")  // whose rig may be the one that is made
        if (auto found = check_places(capture); !found) return found;
    if (preview.has_extension())
        return check_folder_writable(
            std::filesystem::absolute(preview).parent_path(), kPreviewBytes, "--preview");
    return {};
}

}  // namespace atrium::calibrate
