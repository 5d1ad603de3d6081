// The library's instance of the bodies in <pliant/simulate/failure_report-inl.h>.
#include <pliant/simulate/failure_report-inl.h>
