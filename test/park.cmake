# Unit tests of the embedded world, and of the loop that is closed through it.
foreach(name camera_model conditions dataset_generator loop_path park_simulation renderer robot_model)
  perennial_gtest(${name}_test park/${name}_test.cpp LIBRARIES perennial_park opencv_core opencv_imgproc)
endforeach()
perennial_gtest(closed_loop_test park/closed_loop_test.cpp LIBRARIES perennial_park perennial_strategies)
perennial_gtest(along_path_test park/along_path_test.cpp LIBRARIES perennial_park perennial_strategies)
