#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "tools/export/formats/frame.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <optional>

namespace atrium::exporting {

/// A person to encode.
struct PosedPerson {
    const renderer::PersonModel& model;  // without triangles: nobody is there
    geometry::RigidTransform frame_from_site;
    std::optional<Eigen::Vector3f> eye_site;  // that the colours are for; none: along the normals
};

/// Writes frames in one format. Frames are encoded on several threads and added in order.
///
/// Files have their final names only when they are whole: a writer that ends before `finish` leaves
/// no part of a file there. Errors of the disk are kUnavailable and name the file.
class FrameWriter {
public:
    FrameWriter() = default;
    FrameWriter(const FrameWriter&) = delete;
    FrameWriter& operator=(const FrameWriter&) = delete;
    virtual ~FrameWriter() = default;

    /// Thread-safe. A model without triangles gives a frame without a mesh.
    virtual Expected<EncodedFrame> encode(const PosedPerson& person,
                                          const FrameTime& time) const = 0;
    virtual Expected<void> add(EncodedFrame frame) = 0;
    /// After the last frame, also if there are fewer frames than were planned.
    virtual Expected<Written> finish() = 0;
};

}  // namespace atrium::exporting
