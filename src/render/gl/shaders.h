// GLSL 330 text of every program. kShared is placed before each stage.
#pragma once

namespace pliant::shaders {

inline constexpr unsigned kFrameBinding = 0;

extern const char* const kShared;

extern const char* const kShadowVertex;  ///< depth of the bodies from the key light
extern const char* const kHeightVertex;  ///< height of the bodies over the ground, as depth
extern const char* const kDepthFragment;
extern const char* const kContactVertex;  ///< share of the sky that is visible from each point of the ground
extern const char* const kContactFragment;
extern const char* const kBodyVertex;
extern const char* const kOwnColor;  ///< one albedo for the whole body; placed before kBodyFragment
extern const char* const kBodyFragment;
extern const char* const kLeveledVertex;  ///< vertices of a body coloured by values
extern const char* const kLevelColor;  ///< albedo of a body coloured by values; placed before kBodyFragment
extern const char* const kGroundVertex;
extern const char* const kGroundFragment;
extern const char* const kBackgroundVertex;
extern const char* const kBackgroundFragment;
extern const char* const kPresentFragment;  ///< pixels of a window from the samples of the drawn picture
extern const char* const kTrackVertex;
extern const char* const kTrackFragment;

}  // namespace pliant::shaders
