#include "viewer/scene/file_advice.hpp"

#include <system_error>

namespace atrium::viewer {

std::string advice_about(const Error& failure,
                         const std::filesystem::path& folder,
                         const std::string& file,
                         const std::string& mend) {
    namespace fs = std::filesystem;
    if (failure.kind != ErrorKind::kNotFound) return mend;
    fs::path given = folder.lexically_normal();
    if (!given.has_filename()) given = given.parent_path();  // "models/"
    std::error_code failed;
    fs::path above = given.parent_path();
    if (above.empty()) above = ".";
    if (!given.empty() && given != "." && fs::is_regular_file(above / file, failed))
        return "did you mean --viewer.models " + above.string() + "?";
    return "give the folder of the world's models and textures with --viewer.models";
}

std::string differs_line(const std::string& kind,
                         const std::string& file,
                         const std::filesystem::path& folder) {
    return kind + "_differs name=" + file +
           ": the world's server has another version; copy it from there into " +
           (folder.empty() ? "." : folder.string());
}

}  // namespace atrium::viewer
