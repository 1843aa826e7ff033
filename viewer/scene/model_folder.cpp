#include "viewer/scene/model_folder.hpp"

#include "core/bus/names.hpp"
#include "core/geometry/aabb.hpp"
#include "core/model/model_file.hpp"
#include "core/model/pieces.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <system_error>
#include <utility>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMaxFiles = 2000;  // in the list
constexpr std::size_t kMaxLooked = 50'000;
constexpr int kMaxDepth = 6;

// A model that other programs read.
bool is_other_model(const fs::path& file) {
    constexpr std::array<std::string_view, 10> kEndings{
        ".fbx", ".dae", ".blend", ".3ds", ".usd", ".usda", ".usdc", ".usdz", ".step", ".stp"};
    std::string ending = file.extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return std::ranges::find(kEndings, ending) != kEndings.end();
}

}  // namespace

ModelFolder::ModelFolder(const fs::path& folder)
    : reader_([folder](const std::string& file) -> Expected<Read> {
          if (file.empty()) return Read{list_of(folder), {}};
          return Read{{}, measure_file(folder / file)};
      }) {}

std::vector<ModelEntry> ModelFolder::list_of(const fs::path& folder) {
    std::vector<ModelEntry> list;
    std::error_code failure;
    fs::recursive_directory_iterator entry(
        folder, fs::directory_options::skip_permission_denied, failure);
    std::size_t num_looked = 0;
    for (; !failure && entry != fs::end(entry) && list.size() < kMaxFiles &&
           ++num_looked < kMaxLooked;
         entry.increment(failure)) {
        if (entry.depth() >= kMaxDepth) entry.disable_recursion_pending();
        std::error_code ignored;
        if (!entry->is_regular_file(ignored)) continue;
        const bool is_other = is_other_model(entry->path());
        if (!is_other && !model::is_model_name(entry->path())) continue;
        const std::string file = entry->path().lexically_relative(folder).generic_string();
        if (file.starts_with('.') || file.find("/.") != std::string::npos) continue;  // hidden
        std::string problem;
        if (is_other)
            problem = "export it as .glb";
        else if (!bus::is_valid_model_file(file))
            problem = "rename it: A-Z a-z 0-9 _ . - only";
        list.push_back({file, entry->file_size(ignored), std::move(problem)});
    }
    std::sort(
        list.begin(), list.end(), [](const auto& a, const auto& b) { return a.file < b.file; });
    return list;
}

ModelSize ModelFolder::measure_file(const fs::path& file) {
    ModelSize size;
    const auto parts = model::load_model(file);
    if (!parts) {
        size.error = parts.error().message;
        return size;
    }
    geometry::Aabb bounds;
    for (const model::ModelPart& part : *parts) {
        size.num_triangles += part.mesh.triangles.size();
        for (const Eigen::Vector3d& vertex : part.mesh.vertices) bounds.add(vertex);
    }
    size.num_parts = model::pieces_of(*parts, file).size();
    size.size_m = bounds.size();
    size.colours = model::colours_of(*parts);
    size.preview = draw_preview(*parts);
    return size;
}

void ModelFolder::show(bool is_shown) {
    if (!std::exchange(is_shown_, is_shown) && is_shown) scan();
}

void ModelFolder::scan() {
    reader_.forget();
    reader_.want({});
}

void ModelFolder::measure(const std::string& file) {
    if (!file.empty() && !sizes_.contains(file)) reader_.want(file);
}

void ModelFolder::update() {
    for (auto& [file, read] : reader_.take()) {
        if (!read) continue;
        if (file.empty())
            list_ = std::make_shared<const std::vector<ModelEntry>>(std::move(read->list));
        else
            sizes_[file] = std::move(read->size);
    }
}

const ModelSize* ModelFolder::size_of(const std::string& file) const {
    const auto found = sizes_.find(file);
    return found == sizes_.end() ? nullptr : &found->second;
}

}  // namespace atrium::viewer
