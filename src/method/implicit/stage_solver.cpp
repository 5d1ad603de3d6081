// The library's instance of the function bodies in <pliant/method/implicit/stage_solver-inl.h>.
#include <pliant/method/implicit/stage_solver-inl.h>
