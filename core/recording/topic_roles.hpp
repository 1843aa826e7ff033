#pragma once

#include "core/bus/raw_samples.hpp"

#include <optional>
#include <string>
#include <string_view>

/// What the topics of a world are to a recording.
namespace atrium::recording {

/// True for topics whose last sample of each instance counts however old it is (QoS class
/// description). A recording keeps them apart from the others, so that a reader finds all of them
/// quickly.
bool is_kept(const bus::RawTopic& topic);

/// True for topics that tell somebody to do something, once.
bool is_command(const bus::RawTopic& topic);

/// The site that an instance belongs to, from its key (RawTopic::key_of); nullopt: to none.
std::optional<std::string> site_of(const bus::RawTopic& topic, std::string_view key);

/// The site of a camera node or region node: of SITE.HOST (bus::host_program_name).
std::string site_of_host(const std::string& name);

/// Where in such a key the site's name begins.
std::size_t place_of_site(const bus::RawTopic& topic, std::string_view key);

/// True for meshes and textures, nearly all bytes of a recording.
bool is_of_people(const bus::RawTopic& topic);

}  // namespace atrium::recording
