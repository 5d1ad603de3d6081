// The numbers all shaders of one frame share, laid out as the uniform block "Frame" of shaders.cpp (std140).
// Positions are relative to the camera's target, so that single precision suffices far from the world's
// origin. Colours are linear.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <pliant/render/picture.h>

namespace pliant {

struct FrameBlock {
  Eigen::Matrix4f view_projection;  ///< to clip space, far plane at infinity
  Eigen::Matrix4f shadow;           ///< to [0, 1]^3: place on the shadow map and depth from the key light
  Eigen::Matrix4f contact;          ///< to [0, 1]^3: place on the contact map and height over the ground
  Eigen::Vector4f eye;              ///< w: near distance
  Eigen::Vector4f to_key;           ///< w: how far bodies look up their shadow outside their surface, metres
  Eigen::Vector4f key;
  Eigen::Vector4f sky;  ///< w: height over which the ground darkens what is above it, metres
  Eigen::Vector4f bounce;
  Eigen::Vector4f background_top;
  Eigen::Vector4f background_bottom;
  Eigen::Vector4f ground;          ///< w: height
  Eigen::Vector4f ground_ambient;  ///< share of the ambient light in the ground's colour
  Eigen::Vector4f grid_color;
  Eigen::Vector4f grid;  ///< x y: the target on the grid, in cells from a strong line; z: cell, metres
  Eigen::Vector4f fade;  ///< radii between which the ground fades; z: contact texel, w: contact range, metres
  Eigen::Vector4f viewport;  ///< samples; z: side of a shadow texel on its map
};

/// Everything of the frame that follows from the picture, the places of its bodies (boxes relative to the
/// camera's target) and the sizes of the pictures and maps. Throws std::invalid_argument naming the setting
/// that makes no sense.
FrameBlock frame_block(const Picture& picture, const std::vector<Eigen::AlignedBox3f>& boxes,
                       int samples_wide, int samples_high, int shadow_side, int contact_side);

}  // namespace pliant
