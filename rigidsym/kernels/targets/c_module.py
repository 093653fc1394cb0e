def module_files(program, kernels, conversions): return {}
