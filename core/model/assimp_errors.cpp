#include "core/model/assimp_errors.hpp"

#include "core/model/model_file.hpp"

#include <assimp/Importer.hpp>
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace Assimp {

// Takes the place of the function of this name in libassimp, which aborts. Importer catches what is
// thrown and reports it as the error of the file.
[[noreturn]] void aiAssertViolation(const char* expression, const char* /*file*/, int /*line*/);
void aiAssertViolation(const char* expression, const char* /*file*/, int /*line*/) {
    throw std::runtime_error(fmt::format("is damaged (Assimp: {})", expression));
}

}  // namespace Assimp

namespace atrium::model {
namespace {

struct Signature {
    std::string_view bytes;
    std::string_view ending;  // of such a model file; empty: no model
    std::string_view what;
};

using std::string_view_literals::operator""sv;
constexpr std::array kSignatures{
    Signature{"version https://git-lfs"sv, "", "is a pointer of git-lfs: run `git lfs pull`"},
    Signature{"\x89PNG"sv, "", "is a PNG picture, whatever its name says"},
    Signature{"\xFF\xD8\xFF"sv, "", "is a JPEG picture, whatever its name says"},
    Signature{"%PDF"sv, "", "is a PDF document, whatever its name says"},
    Signature{"PK\x03\x04"sv, "", "is a ZIP archive: unpack it"},
    Signature{"BLENDER"sv, "", "is a file of Blender: export it as .glb"},
    Signature{"<!DOCTYPE"sv, "", "is a web page, not a model: download the file itself"},
    Signature{"<!doctype"sv, "", "is a web page, not a model: download the file itself"},
    Signature{"<html"sv, "", "is a web page, not a model: download the file itself"},
    Signature{"Kaydara FBX"sv, ".fbx", "is an FBX file: name it .fbx"},
    Signature{"glTF"sv, ".glb", "is a binary glTF file: name it .glb"},
    Signature{"ply\n"sv, ".ply", "is a PLY file: name it .ply"},
    Signature{"ply\r"sv, ".ply", "is a PLY file: name it .ply"},
};

std::uint32_t number_at(std::string_view head, std::size_t at) {
    std::uint32_t number = 0;  // glTF and STL are little-endian
    std::memcpy(&number, head.data() + at, sizeof number);
    return number;
}

// Empty: not cut off, as far as the length in its header tells.
std::string what_is_missing(std::string_view ending,
                            std::string_view head,
                            std::uintmax_t num_bytes) {
    constexpr std::size_t kStlHeader = 84;
    constexpr std::uintmax_t kStlTriangle = 50;
    std::uintmax_t num_promised = 0;
    if (ending == ".glb" && head.size() >= 12 && head.starts_with("glTF"))
        num_promised = number_at(head, 8);
    if (ending == ".stl" && head.size() >= kStlHeader && !head.starts_with("solid"))
        num_promised = kStlHeader + kStlTriangle * number_at(head, kStlHeader - 4);
    if (num_promised <= num_bytes) return {};
    return fmt::format(
        "is cut off or damaged: has {} of {} bytes; copy it again", num_bytes, num_promised);
}

}  // namespace

std::string why_unreadable(const std::filesystem::path& file, const Assimp::Importer& importer) {
    std::error_code failure;
    const std::uintmax_t num_bytes = std::filesystem::file_size(file, failure);
    if (!failure && num_bytes == 0) return "is empty";
    std::array<char, 128> buffer{};
    std::ifstream stream(file, std::ios::binary);
    stream.read(buffer.data(), buffer.size());
    const std::string_view head(buffer.data(), static_cast<std::size_t>(stream.gcount()));
    const std::string ending = ending_of(file);
    for (const Signature& signature : kSignatures)
        if (head.starts_with(signature.bytes) && ending != signature.ending)
            return std::string(signature.what);
    if (auto missing = what_is_missing(ending, head, num_bytes); !failure && !missing.empty())
        return missing;
    const std::string said = importer.GetErrorString();
    const auto says = [&](std::string_view part) { return said.find(part) != said.npos; };
    if (says("is damaged")) return said;
    if (says("mNumMeshes is 0") || says("contains no faces")) return "has no triangles";
    if (says(" is a LINE but") || says(" is a POINT but"))
        return "is damaged or cut off: one of its faces has fewer than three corners";
    if (says("No suitable reader found") || says("STL storage representation") ||
        says("unexpected end of file"))
        return fmt::format("is damaged, or no {} file", ending);
    return "cannot be read: " + said;
}

}  // namespace atrium::model
