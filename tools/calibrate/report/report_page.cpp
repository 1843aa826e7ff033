#include "tools/calibrate/report/drawings.hpp"
#include "tools/calibrate/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace atrium::calibrate {
namespace {

// Colours follow the reader's choice of light or dark; nothing is loaded from anywhere.
constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --ink: #1b2430; --dim: #667080; --paper: #ffffff; --card: #f4f6f8; --rule: #d5dae0;
  --good: #1a7f4b; --usable: #a66a00; --wrong: #b3261e; --mark: #2563a8; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e9ee; --dim: #98a2b0; --paper: #14181d; --card: #1d232a;
  --rule: #38414c; --good: #4cc38a; --usable: #e0a33c; --wrong: #f2766d; --mark: #6aa9e8; } }
body { margin: 0 auto; max-width: 1180px; padding: 24px; background: var(--paper); color: var(--ink);
  font: 15px/1.5 system-ui, sans-serif; }
h1 { font-size: 24px; margin: 0 0 4px; } h2 { font-size: 18px; margin: 32px 0 8px; } h3 { font-size: 15px; margin: 0 0 6px; }
.dim { color: var(--dim); } .verdict { font-size: 18px; border-left: 6px solid; padding: 6px 14px; margin: 16px 0; }
.good { border-color: var(--good); } .usable { border-color: var(--usable); } .wrong { border-color: var(--wrong); }
ul { padding-left: 20px; margin: 6px 0; } li { margin: 2px 0; }
.problem::marker { content: "\2717\00a0\00a0"; color: var(--wrong); } .check::marker { content: "!\00a0\00a0"; color: var(--usable); }
.table { overflow-x: auto; } table { border-collapse: collapse; } th, td { padding: 4px 12px; text-align: right; border-bottom: 1px solid var(--rule); }
th:first-child, td:first-child { text-align: left; padding-left: 0; } th { font-weight: 600; } td.mark { color: var(--wrong); font-weight: 600; }
.row { display: flex; flex-wrap: wrap; gap: 16px; } .card { background: var(--card); border-radius: 8px; padding: 14px; }
.rig { flex: 1 1 480px; } .camera-card { flex: 1 1 360px; max-width: 560px; } svg { width: 100%; height: auto; display: block; }
svg text { font-size: 12px; fill: var(--ink); } .small { max-width: 290px; }
.floor { stroke: var(--rule); } .seen { fill: var(--mark); fill-opacity: .35; } .camera { stroke: var(--ink); fill: none; }
.old { stroke: var(--dim); stroke-dasharray: 3 3; fill: none; } .axis-x { stroke: #d0362d; stroke-width: 2; }
.axis-y { stroke: #2e9e4f; stroke-width: 2; } .axis-z { stroke: #2f6fd0; stroke-width: 2; }
.picture { fill: none; stroke: var(--rule); } .covered { fill: var(--good); } .point { fill: var(--dim); }
.outlier { fill: none; stroke: var(--wrong); } .error { stroke: var(--mark); stroke-width: 2; } .error-foot { fill: var(--mark); }
.scale { stroke: var(--rule); } .curve { stroke: var(--mark); stroke-width: 2; fill: none; }
.curve-old { stroke: var(--dim); stroke-dasharray: 3 3; fill: none; }
)";

class Page {
public:
    explicit Page(const CalibrationReport& report) : report_(report) {}

    std::string write() {
        head();
        verdict();
        rig();
        table();
        comparison();
        cameras();
        put("</body></html>\n");
        return std::move(html_);
    }

private:
    template <typename... Parts>
    void put(fmt::format_string<Parts...> format, Parts&&... parts) {
        fmt::format_to(std::back_inserter(html_), format, std::forward<Parts>(parts)...);
    }

    const char* grade() const {
        return report_.grade == Grade::kGood     ? "good"
               : report_.grade == Grade::kUsable ? "usable"
                                                 : "wrong";
    }

    void head() {
        put("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><meta "
            "name=\"viewport\" content=\"width=device-width\"/><title>calibration: {}</title>"
            "<style>{}</style></head><body>\n",
            grade(),
            kStyle);
        put("<h1>Calibration of {} cameras</h1><div class=\"dim\">{} from {}, {} UTC</div>\n",
            report_.cameras.size(),
            escaped(report_.command),
            escaped(report_.source),
            escaped(report_.date));
    }

    void list(const std::vector<std::string>& lines, const char* kind) {
        if (lines.empty()) return;
        put("<ul>");
        for (const std::string& line : lines)
            put("<li class=\"{}\">{}</li>\n", kind, escaped(line));
        put("</ul>");
    }

    void verdict() {
        put("<div class=\"verdict {}\">{}</div>\n",
            grade(),
            escaped(report_.told.empty() ? grade() : report_.told.front()));
        put("<p>{}</p>\n", escaped(report_.outcome));
        list(report_.problems, "problem");
        list(report_.checks, "check");
    }

    void rig() {
        put("<h2>The rig</h2><div class=\"row\"><div class=\"card rig\"><h3>From above</h3>{}</div>"
            "<div class=\"card rig\"><h3>From the side</h3>{}</div></div>\n",
            draw_rig(report_, 0.0, 90.0),
            draw_rig(report_, 30.0, 15.0));
        put("<p class=\"dim\">One square of the floor is 1 m. Red, green and blue: X, Y and Z, 0.5 "
            "m each. Dots: what the cameras saw.{}</p>\n",
            report_.comparison ? " Dashed: the rig before." : "");
    }

    void table() {
        put("<h2>Cameras</h2><div class=\"table\"><table><tr><th>camera</th><th>held out "
            "px</th><th>RMS px</th><th>in the middle mm</th><th>points</th><th>outliers</th>"
            "<th>covered</th><th>late instants</th><th>f px</th><th>k1</th><th>k2</th></tr>\n");
        for (const ReportedCamera& one : report_.cameras) {
            const geometry::PinholeCamera& lens = one.camera.intrinsics;
            put("<tr><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{}</td>"
                "<td>{:.0f} %</td><td{}>{:.2f}</td><td>{:.1f}</td><td>{:.4f}</td><td>{:.4f}</td>"
                "</tr>\n",
                escaped(one.camera.name),
                one.held_out_px,
                one.rms_px,
                one.middle_mm,
                one.num_used,
                one.num_outliers,
                100.0 * one.coverage,
                std::abs(one.late_instants) >= 0.25 ? " class=\"mark\"" : "",
                std::round(100.0 * one.late_instants) / 100.0 + 0.0,  // no "-0.00"
                lens.fx,
                lens.distortion[0],
                lens.distortion[1]);
        }
        put("</table></div>\n");
        if (report_.told.size() > 1) {
            put("<details><summary>All that was said</summary>");
            list(report_.told, "said");
            put("</details>\n");
        }
    }

    void comparison() {
        if (!report_.comparison) return;
        const RigComparison& compared = *report_.comparison;
        put("<h2>Beside the rig before</h2><p>{}: {} of {} cameras stand where they did.</p>\n",
            escaped(report_.previous),
            compared.num_staying(),
            compared.moves.size());
        put("<div class=\"table\"><table><tr><th>camera</th><th>moved mm</th><th>turned deg</th>"
            "<th>f</th></tr>\n");
        for (const CameraMove& move : compared.moves) {
            const char* mark = move.stays ? "" : " class=\"mark\"";
            put("<tr><td>{}</td><td{}>{:.1f}</td><td{}>{:.3f}</td><td>{:+.2f} %</td></tr>\n",
                escaped(move.name),
                mark,
                1000.0 * move.moved_m,
                mark,
                move.turned_deg,
                100.0 * (move.focal_ratio - 1.0));
        }
        put("</table></div>\n");
        const auto names = [&](const std::vector<std::string>& of, const char* text) {
            if (of.empty()) return;
            std::string joined;
            for (const std::string& name : of) joined += (joined.empty() ? "" : ", ") + name;
            put("<p>{}: {}.</p>\n", text, escaped(joined));
        };
        names(compared.only_in_new, "New cameras");
        names(compared.only_in_old, "No longer there");
    }

    const geometry::PinholeCamera* lens_before(const std::string& name) const {
        if (!report_.previous_rig) return nullptr;
        const auto& cameras = report_.previous_rig->cameras;
        const auto found = std::ranges::find(cameras, name, &geometry::CalibratedCamera::name);
        return found == cameras.end() ? nullptr : &found->intrinsics;
    }

    void cameras() {
        put("<h2>Each camera's picture</h2><p class=\"dim\">Green fields: covered. Blue: the mean "
            "error of a field; if the arrows form a pattern, the lens is not described well. Red "
            "rings: outliers. The curve: how far the lens moves a point.</p><div "
            "class=\"row\">\n");
        for (const ReportedCamera& one : report_.cameras) {
            put("<div class=\"card camera-card\"><h3>{}</h3>{}<div "
                "class=\"small\">{}</div></div>\n",
                escaped(one.camera.name),
                draw_picture(one),
                draw_distortion(one.camera.intrinsics, lens_before(one.camera.name)));
        }
        put("</div>\n");
    }

    const CalibrationReport& report_;
    std::string html_;
};

}  // namespace

std::string report_page(const CalibrationReport& report) { return Page(report).write(); }

}  // namespace atrium::calibrate
