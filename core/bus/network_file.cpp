#include "core/bus/network_file.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <fstream>
#include <iterator>
#include <sstream>

namespace atrium::bus {

Expected<std::string> read_text_file(const std::filesystem::path& file) {
    std::error_code ignored;
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file, ignored))
        return make_error(ErrorKind::kNotFound, fmt::format("{}: cannot be read", file.string()));
    return std::string(std::istreambuf_iterator<char>(stream), {});
}

Expected<std::string> parse_network_file(std::string_view xml, const std::string& source) {
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_buffer(xml.data(), xml.size());
    if (!result) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: {} at byte {}",
                                      source,
                                      result.description(),
                                      static_cast<long>(result.offset)));
    }
    const pugi::xml_node root = document.document_element();
    if (std::string_view(root.name()) != "CycloneDDS") {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: the root is <{}>, must be <CycloneDDS>", source, root.name()));
    }
    std::ostringstream text;
    root.print(text, "", pugi::format_raw);
    return text.str();
}

Expected<std::string> load_network_file(const std::filesystem::path& file) {
    const auto text = read_text_file(file);
    if (!text) {
        // a word that is no file is more likely a typo on the command line than a file that is gone
        const bool is_word = !file.has_parent_path() && !file.has_extension();
        return make_error(is_word ? ErrorKind::kConfiguration : text.error().kind,
                          "bus.network: must be loopback, lan, wifi, wan, or a file that can be "
                          "read; " +
                              text.error().message);
    }
    return parse_network_file(*text, file.string());
}

}  // namespace atrium::bus
