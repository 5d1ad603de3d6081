// Compiles the functions of joint_solver.h once for the library.
#include <pliant/solve/joint_solver-inl.h>
