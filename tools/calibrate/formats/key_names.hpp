#pragma once

#include "tools/calibrate/formats/camera_keys.hpp"

#include <string>

/// The names of the values of a camera, for camera_keys.cpp.
namespace atrium::calibrate {

inline constexpr Keys kMatrix{"camera_matrix",
                              "cameraMatrix",
                              "camera_intrinsics",
                              "intrinsic_matrix",
                              "intrinsicMatrix",
                              "intrinsics",
                              "intrinsic",
                              "matrix",
                              "mtx",
                              "K",
                              "K_matrix",
                              "K_mat",
                              "M"};
inline constexpr Keys kDistortion{"distortion_coefficients",
                                  "distortionCoefficients",
                                  "dist_coeffs",
                                  "distCoeffs",
                                  "dist_coeff",
                                  "coeffs",
                                  "distortion",
                                  "distortions",
                                  "dist",
                                  "distCoef",
                                  "distortion_params",
                                  "distortion_parameters",
                                  "D"};
// one by one, in OpenCV's order; k1 is always there
inline constexpr Keys kCoefficients{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
inline constexpr Keys kFisheye{"k1", "k2", "k3", "k4"};
inline constexpr Keys kRotation{"Rot",
                                "R",
                                "rotation_matrix",
                                "R_matrix",
                                "R_mat",
                                "rotation",
                                "rvec",
                                "R_vec",
                                "rotation_vector",
                                "r"};
inline constexpr Keys kTranslation{
    "T", "t", "tvec", "T_vec", "translation", "translation_vector", "trans"};
// Rotations and translations that say what they mean: "cw" is a camera from the world.
inline constexpr Keys kRotationCw{"R_cw", "R_w2c", "rvec_cw"};
inline constexpr Keys kRotationWc{"R_wc", "R_c2w", "rvec_wc"};
inline constexpr Keys kTranslationCw{"t_cw", "t_w2c", "tvec_cw"};
inline constexpr Keys kTranslationWc{"t_wc", "t_c2w", "tvec_wc"};
inline constexpr Keys kPose{"extrinsics",
                            "extrinsic",
                            "extrinsic_matrix",
                            "RT",
                            "Rt",
                            "pose",
                            "T_wc",
                            "T_cw",
                            "c2w",
                            "w2c",
                            "cam2world",
                            "world2cam",
                            "camera_to_world",
                            "world_to_camera",
                            "transform"};
inline constexpr Keys kWidth{"image_width", "width", "W"};
inline constexpr Keys kHeight{"image_height", "height", "H"};
inline constexpr Keys kSize{"image_size", "imageSize", "img_size", "size", "resolution"};
inline constexpr Keys kName{
    "camera_name", "name", "camera_id", "cameraId", "cam_id", "cam_name", "id", "serial", "label"};
inline constexpr Keys kModel{"distortion_model", "camera_model", "model"};

/// Whether a key is the whole name of a matrix, distortion or pose. Case does not matter.
bool is_key(const std::string& key);

}  // namespace atrium::calibrate
