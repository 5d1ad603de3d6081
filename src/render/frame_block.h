// The uniform block "Frame" of shaders.cpp (layout std140), which all shaders of a frame use. Positions are
// relative to the target of the camera, so that single precision is accurate enough far from the origin of
// the world. Colours are linear.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <pliant/render/picture.h>

namespace pliant {

/// The sizes of the targets of the passes of a picture.
struct PassSizes {
  int width = 0, height = 0;                   ///< of the picture, pixels
  double samples = 2;                          ///< samples of a pixel along each axis: 2, or at most 1
  int shadow_side = 2048, contact_side = 128;  ///< of the square maps, texels
  bool occlusion = true;                       ///< whether bodies hide the sky from the ground
};

struct FrameBlock {
  Eigen::Matrix4f view_projection;  ///< to clip space, far plane at infinity
  Eigen::Matrix4f shadow;   ///< to [0, 1]^3: position on the shadow map, and depth along the key light
  Eigen::Matrix4f contact;  ///< to [0, 1]^3: position on the contact map, and height over the ground
  Eigen::Vector4f eye;      ///< position of the eye, m; w: distance of the near plane, m
  Eigen::Vector4f to_key;   ///< unit vector to the key light; w: offset of shadow lookups along normals, m
  Eigen::Vector4f key;
  Eigen::Vector4f sky;  ///< w: height over the ground up to which the ground darkens bodies, m
  Eigen::Vector4f bounce;
  Eigen::Vector4f background_top;
  Eigen::Vector4f background_bottom;
  Eigen::Vector4f ground;          ///< w: height, m
  Eigen::Vector4f ground_ambient;  ///< share of the ambient light in the unshadowed light on the ground
  Eigen::Vector4f grid_color;
  Eigen::Vector4f grid;  ///< x y: position of the target, in cells from a strong line; z: size of a cell, m
  Eigen::Vector4f fade;  ///< x y: radii between which the ground fades, m; z: texel of the contact map, m; w:
                         ///< height of the contact map, m
  Eigen::Vector4f viewport;  ///< x y: size in samples; z: texel of the shadow map, as a share of the map; w:
                             ///< half the samples of a pixel along an axis
};

/// Returns the block for a picture. boxes: bounding boxes of the bodies, relative to the target of the camera
/// (m). Throws std::invalid_argument that names the setting that is out of range.
FrameBlock frame_block(const Picture& picture, const std::vector<Eigen::AlignedBox3f>& boxes,
                       const PassSizes& sizes);

}  // namespace pliant
