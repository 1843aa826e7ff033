#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/pipeline.hpp"

/// What hosts of regions add to a metaframe of the model part.
namespace atrium::site_node {

/// Without any mesh: an error if all hulls failed. An empty intersection is a valid answer: nobody
/// is there. `has_own`: this host computes a hull.
Expected<void> failure_without_mesh(const SiteFrame& frame, bool has_own);

/// Adds the counts of regions that another host computed.
void add(const bus::RegionMeshes& remote, SiteFrame& frame);

/// Names the textures that camera nodes publish of this metaframe.
void name_remote_textures(const capture::Metaframe& metaframe, SiteFrame& frame);

/// The hull, with the regions that other hosts computed.
geometry::TriangleMesh whole_mesh(const SiteFrame& frame);

}  // namespace atrium::site_node
