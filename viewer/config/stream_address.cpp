#include "viewer/config/stream_address.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <vector>

namespace atrium::viewer {
namespace {

struct Parts {
    std::string scheme, host, path;
    int port = -1;  // -1: none
    std::vector<std::string> options;
};

tl::unexpected<Error> bad(const std::string& url, const std::string& what) {
    const std::string shown = url.substr(0, url.find('?'));
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format("video.stream: '{}': {}. Valid are srt://HOST:PORT?mode=caller|listener, "
                    "tcp://HOST:PORT, udp://HOST:PORT and rtmp://HOST/APP/KEY",
                    shown,
                    what));
}

int port_of(const std::string& text) {
    const bool is_number =
        !text.empty() && text.size() <= 5 &&
        std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    const int port = is_number ? std::atoi(text.c_str()) : 0;
    return port >= 1 && port <= 65535 ? port : 0;
}

Expected<Parts> split(const std::string& url) {
    const std::size_t scheme_end = url.find("://");
    if (scheme_end == std::string::npos) return bad(url, "has no scheme such as srt://");
    Parts parts;
    parts.scheme = url.substr(0, scheme_end);
    std::string rest = url.substr(scheme_end + 3);
    if (const std::size_t query = rest.find('?'); query != std::string::npos) {
        std::string options = rest.substr(query + 1);
        rest.resize(query);
        while (!options.empty()) {
            const std::size_t end = std::min(options.find('&'), options.size());
            if (end > 0) parts.options.push_back(options.substr(0, end));
            options.erase(0, end + 1);
        }
    }
    if (const std::size_t slash = rest.find('/'); slash != std::string::npos) {
        parts.path = rest.substr(slash);
        rest.resize(slash);
    }
    const std::size_t colon = rest.rfind(':');
    const std::size_t bracket = rest.rfind(']');  // of an IPv6 address
    if (colon != std::string::npos && (bracket == std::string::npos || colon > bracket)) {
        parts.port = port_of(rest.substr(colon + 1));
        if (parts.port == 0)
            return bad(url, fmt::format("'{}' is no port (1 to 65535)", rest.substr(colon + 1)));
        rest.resize(colon);
    }
    parts.host = rest;
    return parts;
}

// Removes `mode` and returns whether it is "listener". Error if it is something else.
Expected<bool> take_mode(const std::string& url, Parts& parts) {
    bool is_listener = false;
    for (auto it = parts.options.begin(); it != parts.options.end();) {
        if (!it->starts_with("mode=")) {
            ++it;
            continue;
        }
        const std::string mode = it->substr(5);
        if (mode != "caller" && mode != "listener")
            return bad(url, fmt::format("mode is '{}', must be caller or listener", mode));
        is_listener = mode == "listener";
        it = parts.options.erase(it);
    }
    return is_listener;
}

}  // namespace

Expected<StreamTarget> parse_stream(const std::string& url) {
    auto parts = split(url);
    if (!parts) return tl::unexpected(parts.error());
    const bool is_rtmp = parts->scheme == "rtmp" || parts->scheme == "rtmps";
    const bool is_srt = parts->scheme == "srt";
    const bool is_tcp = parts->scheme == "tcp";
    const bool is_udp = parts->scheme == "udp";
    if (!is_rtmp && !is_srt && !is_tcp && !is_udp)
        return bad(url, fmt::format("unknown scheme '{}'", parts->scheme));
    const auto listens = take_mode(url, *parts);
    if (!listens) return tl::unexpected(listens.error());
    if (*listens && !is_srt && !is_tcp) return bad(url, "only srt and tcp can listen");
    if (parts->host.empty() && !*listens) return bad(url, "has no host");
    if (parts->port < 0 && !is_rtmp) return bad(url, "has no port");
    if (is_rtmp && parts->path.size() < 2) return bad(url, "has no application, such as /live/key");
    StreamTarget target;
    target.waits_for_receiver = *listens;
    target.format = is_rtmp ? "flv" : "mpegts";
    const std::string host = parts->host.empty() ? "0.0.0.0" : parts->host;
    const std::string port = parts->port < 0 ? "" : fmt::format(":{}", parts->port);
    target.shown = fmt::format("{}://{}{}", parts->scheme, host, port);
    if (is_rtmp) target.shown += parts->path.substr(0, parts->path.rfind('/'));
    if (is_srt)
        parts->options.insert(parts->options.begin(), *listens ? "mode=listener" : "mode=caller");
    if (is_tcp && *listens) parts->options.emplace_back("listen=1");
    if (is_udp) parts->options.emplace_back("pkt_size=1316");  // seven packets of the container
    target.url = fmt::format("{}://{}{}{}", parts->scheme, host, port, is_rtmp ? parts->path : "");
    if (!parts->options.empty()) target.url += fmt::format("?{}", fmt::join(parts->options, "&"));
    return target;
}

}  // namespace atrium::viewer
