#pragma once

#include <string_view>

/// Lists the only reasons for which a test may be skipped. A skip message starts with one of them.
/// skips.cpp, which is linked into every test executable, turns any other skip into a failure.
namespace atrium::test::skip {

inline constexpr std::string_view kNoSharedData = "no shared data: ";   // ../shared/data is absent
inline constexpr std::string_view kNoNetwork = "no private network: ";  // namespaces, tun
inline constexpr std::string_view kNoDisplay = "no display: ";          // Xvfb
inline constexpr std::string_view kNoEgl = "no EGL: ";                  // no GPU and no driver
inline constexpr std::string_view kNoAvx2 = "no AVX2 in this processor";
inline constexpr std::string_view kNoWaitTimes = "no count of waits in this kernel";
inline constexpr std::string_view kNoCgal = "no CGAL (libcgal-dev) when this was configured";
inline constexpr std::string_view kNoPythonOpenCv = "no OpenCV for Python (python3-opencv)";
inline constexpr std::string_view kNoSystemd = "no systemd: ";  // systemd-analyze
inline constexpr std::string_view kSanitizer = "sanitizers need more address space";
inline constexpr std::string_view kRenewed = "golden picture renewed: ";  // ATRIUM_RENEW_GOLDEN

/// Returns true if the message of a skip starts with a reason above, and shared data is missing if
/// that is the reason.
bool is_allowed(std::string_view message);

}  // namespace atrium::test::skip
