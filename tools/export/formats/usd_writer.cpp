#include "tools/export/formats/usd_writer.hpp"

#include "core/base/write_check.hpp"
#include "tools/export/atlas/bake.hpp"
#include "tools/export/formats/output_file.hpp"
#include "tools/export/formats/place_mesh.hpp"
#include "tools/export/formats/texture_bytes.hpp"

#include <fmt/format.h>

#include <cctype>
#include <iterator>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace atrium::exporting {
namespace {

namespace fs = std::filesystem;

// Names of prims have letters, digits and underscores.
std::string prim_name(const std::string& name) {
    std::string result = name;
    for (char& c : result) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    }
    if (result.empty() || std::isdigit(static_cast<unsigned char>(result.front())) != 0)
        result.insert(result.begin(), '_');
    return result;
}

// Text in double quotes.
std::string usd_string(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += std::iscntrl(static_cast<unsigned char>(c)) != 0 ? ' ' : c;
    }
    return result + '"';
}

template <typename Values, typename Write>
void write_list(const char* what, const Values& values, std::string& text, Write&& write) {
    text += fmt::format("            {} = [", what);
    bool is_first = true;
    for (const auto& value : values) {
        if (!is_first) text += ", ";
        is_first = false;
        write(value, std::back_inserter(text));
    }
    text += "]";
}

void write_mesh(const TexturedMesh& mesh, std::string& text) {
    Eigen::Vector3f low = mesh.positions.front();
    Eigen::Vector3f high = low;
    for (const Eigen::Vector3f& p : mesh.positions) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const auto point = [](const Eigen::Vector3f& p, auto out) {
        fmt::format_to(out, "({:.5f}, {:.5f}, {:.5f})", p.x(), p.y(), p.z());
    };
    text +=
        "        def Mesh \"mesh\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n"
        "        )\n        {\n            uniform token subdivisionScheme = \"none\"\n";
    write_list("float3[] extent", std::array{low, high}, text, point);
    text += '\n';
    write_list("int[] faceVertexCounts", mesh.triangles, text, [](const auto&, auto out) {
        fmt::format_to(out, "3");
    });
    text += '\n';
    write_list("int[] faceVertexIndices", mesh.triangles, text, [&](const auto& t, auto out) {
        fmt::format_to(out,
                       "{}, {}, {}",
                       mesh.position_of[t[0]],
                       mesh.position_of[t[1]],
                       mesh.position_of[t[2]]);
    });
    text += '\n';
    write_list("point3f[] points", mesh.positions, text, point);
    text += '\n';
    write_list("texCoord2f[] primvars:st", mesh.uvs, text, [](const auto& uv, auto out) {
        fmt::format_to(out, "({:.6f}, {:.6f})", uv.x(), 1.0f - uv.y());
    });
    text += " (\n                interpolation = \"faceVarying\"\n            )\n";
    write_list("int[] primvars:st:indices", mesh.triangles, text, [](const auto& t, auto out) {
        fmt::format_to(out, "{}, {}, {}", t[0], t[1], t[2]);
    });
    text += '\n';
}

// `at`: path of the frame's prim.
std::string material_text(const std::string& at, const std::string& picture) {
    return fmt::format(R"(            rel material:binding = <{0}/material>
        }}

        def Material "material"
        {{
            token outputs:surface.connect = <{0}/material/surface.outputs:surface>

            def Shader "surface"
            {{
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor.connect = <{0}/material/picture.outputs:rgb>
                float inputs:roughness = 1
                color3f inputs:specularColor = (0, 0, 0)
                int inputs:useSpecularWorkflow = 1
                token outputs:surface
            }}

            def Shader "picture"
            {{
                uniform token info:id = "UsdUVTexture"
                asset inputs:file = @{1}@
                token inputs:sourceColorSpace = "sRGB"
                float2 inputs:st.connect = <{0}/material/st.outputs:result>
                token inputs:wrapS = "clamp"
                token inputs:wrapT = "clamp"
                float3 outputs:rgb
            }}

            def Shader "st"
            {{
                uniform token info:id = "UsdPrimvarReader_float2"
                string inputs:varname = "st"
                float2 outputs:result
            }}
        }}
)",
                       at,
                       picture);
}

class UsdWriter final : public FrameWriter {
public:
    UsdWriter(UsdOptions options, ExportFacts facts)
        : options_(std::move(options)),
          facts_(std::move(facts)),
          site_(prim_name(facts_.site)),
          textures_(options_.file.stem().string() + "_textures") {}

    ~UsdWriter() override {
        if (is_whole_) return;
        std::error_code ignored;
        for (const fs::path& picture : written_.files) fs::remove(picture, ignored);
        // only if nothing else is in it
        fs::remove(options_.file.parent_path() / textures_, ignored);
    }

    Expected<EncodedFrame> encode(const PosedPerson& person, const FrameTime& time) const override {
        EncodedFrame frame;
        frame.time = time;
        TexturedMesh baked = bake(person.model, person.eye_site);
        if (baked.triangles.empty()) return frame;
        place(person.frame_from_site, baked.positions);
        std::string text;
        write_mesh(baked, text);
        text += material_text(fmt::format("/{}/{}", site_, frame_name(time)),
                              "./" + (textures_ / picture_name(time)).string());
        frame.mesh.assign(text.begin(), text.end());
        auto jpeg = texture_bytes(baked.texture, options_.jpeg_quality);
        if (!jpeg) return tl::unexpected(jpeg.error());
        frame.picture = std::move(*jpeg);
        return frame;
    }

    Expected<void> add(EncodedFrame frame) override {
        if (!out_) {
            if (auto begun = begin(); !begun) return begun;
        }
        if (last_) {
            if (auto done = write_frame(*last_, frame.time.time_s); !done) return done;
        }
        last_ = std::move(frame);
        return {};
    }

    Expected<Written> finish() override {
        if (!out_) return written_;
        if (last_) {
            if (auto done = write_frame(*last_, std::nullopt); !done)
                return tl::unexpected(done.error());
        }
        if (auto done = out_->write("}\n"); !done) return tl::unexpected(done.error());
        if (auto done = out_->commit(); !done) return tl::unexpected(done.error());
        is_whole_ = true;
        written_.bytes += out_->num_bytes();
        written_.files.insert(written_.files.begin(), options_.file);
        return written_;
    }

private:
    static std::string frame_name(const FrameTime& time) {
        return fmt::format("frame_{:06}", time.number);
    }
    std::string picture_name(const FrameTime& time) const {
        return fmt::format("{}_{:06}.jpg", options_.file.stem().string(), time.number);
    }
    double code(double time_s) const { return time_s * facts_.rate_hz; }

    Expected<void> begin() {
        const fs::path folder = options_.file.parent_path() / textures_;
        std::error_code failure;
        fs::create_directories(folder, failure);
        if (failure) return tl::unexpected(cannot_write(folder, "create", failure.value()));
        auto created = OutputFile::create(options_.file);
        if (!created) return tl::unexpected(created.error());
        out_ = std::move(*created);
        return out_->write(fmt::format(R"(#usda 1.0
(
    customLayerData = {{
        string axes = "{0}"
        string begin_utc = {1}
        string colours_for = {8}
        string frame_of_reference = {2}
        string generator = {3}
        double rate_hz = {4:.6g}
        string source = {5}
        string units = "m"
    }}
    defaultPrim = "{6}"
    endTimeCode = {7:.4f}
    framesPerSecond = {4:.6g}
    metersPerUnit = 1
    startTimeCode = 0
    timeCodesPerSecond = {4:.6g}
    upAxis = "Z"
)

def Xform "{6}" (
    kind = "component"
)
{{
)",
                                       kOwnAxes,
                                       usd_string(facts_.begin_utc),
                                       usd_string(facts_.frame_of_reference),
                                       usd_string(facts_.generator),
                                       facts_.rate_hz,
                                       usd_string(facts_.source),
                                       site_,
                                       code(options_.end_s),
                                       usd_string(facts_.colours_for)));
    }

    // `end_s`: when the next frame takes over.
    Expected<void> write_frame(const EncodedFrame& frame, std::optional<double> end_s) {
        if (frame.mesh.empty()) return {};
        const fs::path picture = options_.file.parent_path() / textures_ / picture_name(frame.time);
        if (auto done = write_file(picture, frame.picture); !done) return done;
        written_.files.push_back(picture);
        written_.bytes += frame.picture.size();
        std::string text = fmt::format("    def Xform \"{}\"\n    {{\n", frame_name(frame.time));
        text += "        token visibility.timeSamples = {\n";
        if (frame.time.time_s > 0.0) text += "            0: \"invisible\",\n";
        text += fmt::format("            {:.4f}: \"inherited\",\n", code(frame.time.time_s));
        if (end_s) text += fmt::format("            {:.4f}: \"invisible\",\n", code(*end_s));
        text += "        }\n\n";
        if (auto done = out_->write(text); !done) return done;
        if (auto done = out_->write(frame.mesh); !done) return done;
        return out_->write("    }\n\n");
    }

    UsdOptions options_;
    ExportFacts facts_;
    std::string site_;
    fs::path textures_;  // folder beside the file
    std::optional<OutputFile> out_;
    std::optional<EncodedFrame> last_;  // waits for the time of the next one
    Written written_;
    bool is_whole_ = false;
};

}  // namespace

std::unique_ptr<FrameWriter> make_usd_writer(const UsdOptions& options, const ExportFacts& facts) {
    return std::make_unique<UsdWriter>(options, facts);
}

}  // namespace atrium::exporting
