#include "core/bus/network_file.hpp"

#include "core/base/text_file.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

namespace atrium::bus {
namespace {

std::ptrdiff_t num_line_ends(std::string_view text) { return std::ranges::count(text, '\n'); }

/// Inserts line ends between the elements of a document: each element gets the line number that it
/// has in `xml`, from which the document was parsed.
class LineKeeper : public pugi::xml_tree_walker {
public:
    explicit LineKeeper(std::string_view xml) : xml_(xml) {}

    void keep_lines(pugi::xml_node root) {
        root.traverse(*this);
        std::ptrdiff_t line = 0;  // current line of the output, from 0
        for (const auto& [node, line_there] : found_) {
            if (node.type() != pugi::node_element) {
                line += num_line_ends(node.value());
            } else if (line_there > line) {
                const std::string ends(static_cast<std::size_t>(line_there - line), '\n');
                node.parent().insert_child_before(pugi::node_pcdata, node).set_value(ends.c_str());
                line = line_there;
            }
        }
    }

private:
    bool for_each(pugi::xml_node& node) override {
        const std::ptrdiff_t offset = std::max<std::ptrdiff_t>(node.offset_debug(), 0);
        found_.emplace_back(node, num_line_ends(xml_.substr(0, static_cast<std::size_t>(offset))));
        return true;
    }

    std::string_view xml_;
    std::vector<std::pair<pugi::xml_node, std::ptrdiff_t>> found_;  // in the order of the text
};

}  // namespace

tl::unexpected<Error> malformed_xml(std::string_view xml,
                                    const std::string& source,
                                    std::string_view what,
                                    std::ptrdiff_t offset) {
    const auto place = static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0));
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format("{}:{}: not valid XML, perhaps cut off or damaged: {}; compare it with the "
                    "files in qos/",
                    source,
                    num_line_ends(xml.substr(0, place)) + 1,
                    what));
}

Expected<std::string> parse_network_file(std::string_view xml, const std::string& source) {
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_buffer(xml.data(), xml.size());
    if (!result) return malformed_xml(xml, source, result.description(), result.offset);
    pugi::xml_node root = document.document_element();
    if (std::string_view(root.name()) != "CycloneDDS") {
        const bool has_profiles = std::string_view(root.name()) == "dds";
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: the root is <{}>, must be <CycloneDDS>{}",
                        source,
                        root.name(),
                        has_profiles ? "; QoS profiles are given with --bus.profiles_file" : ""));
    }
    LineKeeper(xml).keep_lines(root);
    std::ostringstream text;
    root.print(text, "", pugi::format_raw);
    return text.str();
}

Expected<std::string> load_network_file(const std::filesystem::path& file) {
    const auto text = read_text_file(file);
    if (!text) {
        // a single word is more likely a mistyped option than a missing file
        const bool is_word = !file.has_parent_path() && !file.has_extension();
        return make_error(is_word ? ErrorKind::kConfiguration : text.error().kind,
                          "bus.network: must be loopback, lan, wifi, wan, or a readable file; " +
                              text.error().message);
    }
    return parse_network_file(*text, file.string());
}

}  // namespace atrium::bus
