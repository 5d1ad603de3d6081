// The library compiles the bodies of this header here.
#include <pliant/solve/joint_solver-inl.h>
