// The coefficients of the method of Dormand and Prince (1980), in the form of Hairer, Norsett & Wanner,
// Solving Ordinary Differential Equations I, table II.5.2 and section II.6.
#pragma once

#include <pliant/method/dormand_prince.h>

#include <pliant/math/header_only.h>

namespace pliant {

namespace dormand_prince {

inline constexpr double kA[] = {1. / 5,       3. / 40,       9. / 40,        44. / 45,      -56. / 15,
                                32. / 9,      19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729,
                                9017. / 3168, -355. / 33,    46732. / 5247,  49. / 176,     -5103. / 18656};
inline constexpr double kB[] = {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84};
inline constexpr double kC[] = {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1};
// b minus the weights of the embedded method of order 4. The last entry is for the rates at the end of the
// step.
inline constexpr double kError[] = {71. / 57600,      0,         -71. / 16695, 71. / 1920,
                                    -17253. / 339200, 22. / 525, -1. / 40};
inline constexpr double kExtensionD[] = {-12715105075. / 11282082432,  0,
                                         87487479700. / 32700410799,   -10690763975. / 1880347072,
                                         701980252875. / 199316789632, -1453857185. / 822651844,
                                         69997945. / 29380423};
// The dense output has order 4 and needs no additional stage; its error is O(h^5).
inline constexpr ContinuousExtension kExtension{0, nullptr, nullptr, 1, kExtensionD};
inline constexpr ButcherTableau kTableau{"dormand_prince", 5,       6, kA,   kB,         kC,
                                         kError,           nullptr, 4, true, &kExtension};

}  // namespace dormand_prince

PLIANT_INLINE DormandPrince::DormandPrince() : ExplicitRungeKutta(dormand_prince::kTableau) {}

}  // namespace pliant
